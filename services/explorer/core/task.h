#pragma once

#include <vector>

#include "services/explorer/core/path/narrow_passage.h"
#include "services/explorer/core/plan.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// A plan that is being carried out, and what it was made for.
struct Task {
  Plan plan;
  std::vector<double> clearance;   ///< [m] From occupied voxels, of each segment of its path.
  std::vector<bool> narrow;        ///< Of each pose of the path, see FacedPath.
  std::vector<VoxelIndex> target;  ///< Voxels to be seen; see Aim.
  Choice choice;                   ///< Without a path when there was nothing to choose.
  bool turn_first = false;         ///< Before it sets out, see FacedPath.

  /// Sets the target, unknown voxels and doubtful ones.
  void Aim(std::vector<VoxelIndex> at, const PlanningMap& map);
  void DropTarget();
  /// How many voxels of the target were doubtful when it was set; the others were unknown.
  std::size_t doubtful_in_target() const;
  /// Adopts a path, measuring its clearance, as far as `enough` [m].
  void Follow(FacedPath path, const PlanningMap& map, double enough);
  /// Whether what lies ahead of a robot on the path keeps `least` [m] from what is occupied, or what it kept
  /// when it was planned.
  bool StillClear(const PlanningMap& map, const Eigen::Vector3d& p_W, double least) const;
  /// Whether a robot on the path is turned as it must be there. At the beginning of the path the answer is
  /// yes: the robot has just turned, and another answer would keep it there.
  bool FacesNarrowPassage(const RigidTransform& T_WB) const;
  /// [voxels] Of the target, those that are known now; of those that were only doubtful, for sure.
  std::size_t KnownOfTarget(const PlanningMap& map) const;

 private:
  std::vector<bool> was_doubtful_;  ///< Of each voxel of the target.
};

}  // namespace thalweg::explorer
