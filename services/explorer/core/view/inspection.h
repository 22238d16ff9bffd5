#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "services/explorer/core/map/inspected_surface.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

struct InspectionOptions {
  InspectionCriterion criterion;
  double min_area = 0.2;  ///< [m^2] A turn on the spot that inspects less is not worth taking.
  /// Width of a strip along the path, as a share of the criterion's distance, that is worth the path. 0 = any
  /// surface is.
  double least_strip = 0.15;
  double eagerness = 2.0;  ///< [m] Tour length accepted in order to inspect everything one meter earlier.
  double stop_cost = 0.3;  ///< [m] Path that a stop counts as, however near it is.
};

/// A view that inspects surface.
struct InspectionView {
  VoxelIndex place;  ///< The body's; reached.
  Eigen::Matrix3d R_WB;
  std::vector<Facet> facets;  ///< The open ones that it would inspect.
  double length = 0.0;        ///< [m] The shortest path's, to the place.
};

/// The places where a robot could stand to look: of the reached voxels the one nearest to the middle of each
/// cube of 4 x 4 x 4 voxels. In the order of their cubes.
std::vector<VoxelIndex> PlacesToLook(const PathSearch& search);

/// What lies near a voxel, by the blocks in which its voxels are.
class NearIndex {
 public:
  /// @param reach  [voxels] What counts as near, on each axis.
  explicit NearIndex(int reach) : reach_(reach) {}
  void Add(const VoxelIndex& at, std::size_t number) {
    blocks_[OccupancyGrid::BlockOf(at)].push_back(number);
  }
  /// The numbers of all that is near, and of some that is not.
  std::vector<std::size_t> Near(const VoxelIndex& i) const;

 private:
  int reach_;
  std::unordered_map<VoxelIndex, std::vector<std::size_t>, VoxelIndexHash> blocks_;
};

/// The views that inspect what surface is open at one moment. Keeps references.
class InspectionViews {
 public:
  /// @param surface  The map's; it caches what is computed of it meanwhile.
  InspectionViews(const PlanningMap& map, const ViewPlanner& views, const InspectionCriterion& criterion,
                  InspectedSurface& surface);

  const PlanningMap& map() const { return map_; }
  const std::vector<Facet>& open() const { return open_; }  ///< All open facets.
  int reach() const { return reach_; }                      ///< [voxels] How far an inspection reaches.

  /// Whether some view of a body in that voxel inspects a facet.
  bool CanInspect(const VoxelIndex& place, const Facet& facet) const;
  /// The view from a place that inspects most, of equal ones the nearest to an orientation; nothing if it
  /// inspects fewer facets than are enough. Its length is 0.
  std::optional<InspectionView> Best(const VoxelIndex& place, const Eigen::Matrix3d& R_WB,
                                     std::size_t enough) const;

 private:
  const PlanningMap& map_;
  const ViewPlanner& views_;
  InspectedSurface& surface_;
  int reach_;
  std::vector<Facet> open_;
  NearIndex near_;  ///< Numbers of open facets.
};

}  // namespace thalweg::explorer
