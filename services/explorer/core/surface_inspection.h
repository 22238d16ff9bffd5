#pragma once

#include <optional>
#include <span>

#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/plan.h"
#include "services/explorer/core/strategy/inspection_tour.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/view/inspection.h"

namespace thalweg::explorer {

/// Inspects surface where the strategy wants it: finds the views for it, and knows when one has done its
/// work. What was inspected is part of the Knowledge. Threading: one thread owns it.
class SurfaceInspection {
 public:
  /// Adopts what a strategy wants inspected, and forgets what was inspected so far.
  void Follow(const Strategy& strategy, Knowledge& knowledge);

  bool wanted() const { return wanted_.has_value(); }
  /// The view to take next, as InspectionTour::Next; nothing if nothing is wanted.
  std::optional<InspectionView> Next(Knowledge& knowledge, const PathSearch& search,
                                     const RigidTransform& T_WB, const std::optional<VoxelIndex>& frontier);

 private:
  struct Wanted {
    InspectionOptions options;
    InspectionTour tour;
  };
  std::optional<Wanted> wanted_;
};

/// States in a plan what its view is to inspect.
void DescribeInspection(const InspectionView& view, const PlanningMap& map, Plan& plan);

/// Whether so much of the facets is inspected that another view is worth more, or none is wanted any more.
/// @param enough  Share of the facets, 0 to 1.
bool AreInspected(std::span<const Facet> facets, const Knowledge& knowledge, double enough);

}  // namespace thalweg::explorer
