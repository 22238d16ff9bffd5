#include "services/explorer/core/view/inspection.h"

#include <cmath>
#include <limits>
#include <map>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/grid_order.h"

namespace thalweg::explorer {
namespace {

constexpr int kCubeBits = 2;
constexpr int kCube = 1 << kCubeBits;  // [voxels]

/// Squared distance of a voxel from the middle of its cube, in half voxels.
int OffMiddle(const VoxelIndex& i, const VoxelIndex& cube) {
  const auto off_on = [](int v, int of) { return 2 * (v - of * kCube) + 1 - kCube; };
  const VoxelIndex off{off_on(i.x, cube.x), off_on(i.y, cube.y), off_on(i.z, cube.z)};
  return off.x * off.x + off.y * off.y + off.z * off.z;
}

}  // namespace

std::vector<VoxelIndex> PlacesToLook(const PathSearch& search) {
  struct Nearest {
    VoxelIndex voxel;
    int off = std::numeric_limits<int>::max();
  };
  std::map<VoxelIndex, Nearest, GridOrder> cubes;
  ForEachVoxel(search.costs().box(), [&](const VoxelIndex& i) {
    if (search.costs()[i] == PathSearch::kUnreached) return;
    const VoxelIndex cube{i.x >> kCubeBits, i.y >> kCubeBits, i.z >> kCubeBits};
    Nearest& nearest = cubes[cube];
    const int off = OffMiddle(i, cube);
    if (off < nearest.off) nearest = {i, off};
  });
  std::vector<VoxelIndex> places;
  places.reserve(cubes.size());
  for (const auto& [cube, nearest] : cubes) places.push_back(nearest.voxel);
  return places;
}

std::vector<std::size_t> NearIndex::Near(const VoxelIndex& i) const {
  const VoxelIndex reach{reach_, reach_, reach_};
  std::vector<std::size_t> numbers;
  const VoxelBox near{OccupancyGrid::BlockOf(i - reach),
                      OccupancyGrid::BlockOf(i + reach) + VoxelIndex{1, 1, 1}};
  ForEachVoxel(near, [&](const VoxelIndex& block) {
    const auto found = blocks_.find(block);
    if (found != blocks_.end()) numbers.insert(numbers.end(), found->second.begin(), found->second.end());
  });
  return numbers;
}

InspectionViews::InspectionViews(const PlanningMap& map, const ViewPlanner& views,
                                 const InspectionCriterion& criterion, InspectedSurface& surface)
    : map_(map),
      views_(views),
      surface_(surface),
      reach_(static_cast<int>(std::ceil(criterion.distance / map.voxel_size()))),
      open_(surface.OpenFacets(map)),
      near_(reach_) {
  for (std::size_t n = 0; n < open_.size(); ++n) near_.Add(open_[n].voxel, n);
}

bool InspectionViews::CanInspect(const VoxelIndex& place, const Facet& facet) const {
  const Eigen::Vector3d eye_W = map_.CenterOf(map_.EyeOf(place));
  return surface_.InspectableFrom(map_, eye_W, facet) && views_.CanShow(CenterOf(map_, facet) - eye_W);
}

std::optional<InspectionView> InspectionViews::Best(const VoxelIndex& place, const Eigen::Matrix3d& R_WB,
                                                    std::size_t enough) const {
  const VoxelIndex eye = map_.EyeOf(place);
  const Eigen::Vector3d eye_W = map_.CenterOf(eye);
  std::vector<Facet> facets;
  std::vector<Sighting> sightings;
  for (const std::size_t n : near_.Near(eye)) {
    if (!CanInspect(place, open_[n])) continue;
    facets.push_back(open_[n]);
    sightings.push_back({open_[n].voxel, CenterOf(map_, open_[n]) - eye_W});
  }
  if (facets.empty() || facets.size() < enough) return std::nullopt;
  const View best = views_.Best(sightings, std::vector<bool>(sightings.size(), true), {}, R_WB);
  if (best.count < enough) return std::nullopt;
  InspectionView view{.place = place, .R_WB = best.R_WB, .facets = {}};
  for (std::size_t n = 0; n < facets.size(); ++n) {
    if (views_.Shows(view.R_WB, sightings[n])) view.facets.push_back(facets[n]);
  }
  return view;
}

}  // namespace thalweg::explorer
