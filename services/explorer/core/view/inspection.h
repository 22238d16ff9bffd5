#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "services/explorer/core/map/inspected_surface.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

struct InspectionOptions {
  InspectionCriterion criterion;
  double min_area = 0.5;   ///< [m^2] A view that inspects less is not worth taking.
  double stop_cost = 0.5;  ///< [m] Path that a stop counts as, however near it is.
};

/// A view that inspects surface.
struct InspectionView {
  VoxelIndex place;  ///< The body's; reached.
  Eigen::Matrix3d R_WB;
  std::vector<Facet> facets;  ///< The open ones that it would inspect.
  double length = 0.0;        ///< [m] The shortest path's, to the place.
};

/// Finds where the robot can inspect most open surface per meter of path, by any number of views, since
/// turning costs no path: the greedy rule for covering a set at least cost [Chvátal: A greedy heuristic for
/// the set-covering problem, Mathematics of Operations Research 4(3), 1979], one step of it. What can be
/// inspected from where the robot stands comes first.
///
/// One place is tried in each cell of 4 x 4 x 4 voxels, the reached one nearest to the cell's middle, and the
/// robot's own. What a place could inspect when it was last examined bounds what it can inspect now, unless
/// the map has changed near it, so that few places are examined again [Minoux: Accelerated greedy algorithms
/// for maximizing submodular set functions, 1978].
///
/// Threading: one thread owns a planner.
class InspectionPlanner {
 public:
  explicit InspectionPlanner(const InspectionOptions& options) : options_(options) {}

  /// @param search      Flooded from the robot.
  /// @param T_WB        Pose of the robot.
  /// @param max_length  [m] Places with longer paths are not tried.
  /// @param surface     Always the same, and of that map.
  /// @return From the best place the view that inspects most; nothing when no view inspects `min_area`.
  std::optional<InspectionView> Best(const PlanningMap& map, const PathSearch& search,
                                     const ViewPlanner& views, const RigidTransform& T_WB, double max_length,
                                     InspectedSurface& surface);

 private:
  void ForgetChanged(const PlanningMap& map, const InspectedSurface& surface);

  InspectionOptions options_;
  std::uint64_t revision_ = 0;  ///< The surface's, at the last call.
  /// By voxels of cameras: the open facets that it could inspect when last examined; 0 = too few in any view.
  std::unordered_map<VoxelIndex, std::size_t, VoxelIndexHash> bounds_;
};

}  // namespace thalweg::explorer
