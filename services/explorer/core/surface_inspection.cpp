#include "services/explorer/core/surface_inspection.h"

#include <algorithm>

namespace thalweg::explorer {

void SurfaceInspection::Follow(const Strategy& strategy, Knowledge& knowledge) {
  const InspectionOptions* const options = strategy.inspection();
  wanted_.reset();
  if (options != nullptr) wanted_ = {*options, InspectionTour(*options)};
  knowledge.Inspect(options != nullptr ? std::optional(options->criterion) : std::nullopt);
}

std::optional<InspectionView> SurfaceInspection::Next(Knowledge& knowledge, const PathSearch& search,
                                                      const RigidTransform& T_WB,
                                                      const std::optional<VoxelIndex>& frontier) {
  if (!wanted_) return std::nullopt;
  const InspectionViews views(knowledge.map(), knowledge.views(), wanted_->options.criterion,
                              *knowledge.inspected());
  return wanted_->tour.Next(views, search, T_WB, frontier);
}

void DescribeInspection(const InspectionView& view, const PlanningMap& map, Plan& plan) {
  plan.purpose = Purpose::kInspect;
  plan.inspects = static_cast<double>(view.facets.size()) * map.voxel_size() * map.voxel_size();
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();
  for (const Facet& facet : view.facets) center_W += CenterOf(map, facet);
  plan.target_W = center_W / static_cast<double>(view.facets.size());
}

bool AreInspected(std::span<const Facet> facets, const Knowledge& knowledge, double enough) {
  const InspectedSurface* const surface = knowledge.inspected();
  if (surface == nullptr) return true;  // the strategy is another one by now
  const auto open = std::ranges::count_if(
      facets, [&](const Facet& facet) { return surface->Open(knowledge.map(), facet); });
  return static_cast<double>(open) <= (1.0 - enough) * static_cast<double>(facets.size());
}

}  // namespace thalweg::explorer
