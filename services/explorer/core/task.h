#pragma once

#include <optional>
#include <vector>

#include "services/explorer/core/map/inspected_surface.h"
#include "services/explorer/core/path/narrow_passage.h"
#include "services/explorer/core/plan.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// A plan being executed, and what it was made for.
struct Task {
  Plan plan;
  std::vector<double> clearance;   ///< [m] Clearance of each segment of the path from occupied voxels.
  std::vector<bool> narrow;        ///< For each pose of the path, see FacedPath.
  std::vector<VoxelIndex> target;  ///< Voxels to be seen; see Aim.
  std::vector<Facet> facets;       ///< Surface to be inspected.
  Choice choice;                   ///< Without a path when there was nothing to choose.
  bool turn_first = false;         ///< Turn before setting out, see FacedPath.
  /// Where the path turns off before the end of what leads to it: how many poses of that come before it.
  std::optional<std::size_t> lead_poses;

  /// Sets the target: unknown and doubtful voxels.
  void Aim(std::vector<VoxelIndex> at, const PlanningMap& map);
  void DropTarget();  ///< Drops the facets, too.
  /// How many voxels of the target were doubtful when it was set; the others were unknown.
  std::size_t doubtful_in_target() const;
  /// Adopts a path and computes its clearance, up to `enough` [m].
  void Follow(FacedPath path, const PlanningMap& map, double enough);
  /// Where the robot can leave the path.
  struct Departure {
    FacedPath lead;       ///< The path from the robot to there; the last segment is straight.
    RigidTransform T_WB;  ///< Pose there, with the orientation that it can have turned to.
    /// Where the robot is when it hears of the next path.
    struct Hearing {
      std::size_t pose = 0;  ///< of `lead`
      RigidTransform T_WB;   ///< With the orientation that it can have turned to.
      double left = 0.0;     ///< [m] From there to the end of the path.
    } hears;
  };
  /// What a robot passes on its path.
  struct Stretch {
    double length = 0.0;  ///< [m] At least.
    double time = 0.0;    ///< [s] At least.
  };
  /// @param reacts  Until the robot hears of the next path.
  /// @param brakes  From there to where it can leave this one.
  /// @return        Empty for a robot beside the path, or when it has no way to go on it.
  std::optional<Departure> DepartAhead(const RigidTransform& T_WB, const Stretch& reacts,
                                       const Stretch& brakes, const RobotModel& robot) const;
  /// Inserts what leads to the path from where the robot is.
  void Prepend(const FacedPath& lead, const PlanningMap& map, double enough);
  /// Whether the path ahead of the robot keeps `least` [m] from occupied voxels, or the clearance it had when
  /// planned, if that was less. Where that is less than the body's `radius` [m], it must touch none that it
  /// does not touch at `p_W`.
  bool StillClear(const PlanningMap& map, const Eigen::Vector3d& p_W, double least, double radius) const;
  /// Whether a robot on the path has the orientation that a narrow passage requires. Always true at the
  /// beginning of the path: the robot has just turned, and another answer would keep it there.
  bool FacesNarrowPassage(const RigidTransform& T_WB) const;
  /// Number of target voxels that are known by now; those that were doubtful must be known with confidence.
  std::size_t KnownOfTarget(const PlanningMap& map) const;

 private:
  std::vector<bool> was_doubtful_;  ///< For each voxel of the target.
};

}  // namespace thalweg::explorer
