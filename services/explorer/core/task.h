#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/explorer/core/path/narrow_way.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// What to do next.
struct Plan {
  enum class Kind : std::uint8_t {
    kLook,  ///< Turn on the spot and see, perhaps only to go on facing the way.
    kGo,    ///< Go to a frontier, facing the unknown at the end.
    kDone,  ///< See stop_reason.
  };
  Kind kind = Kind::kDone;
  std::vector<RigidTransform> T_WBs;  ///< Path of the body, the present place first; empty when done.
  std::string activity;               ///< One line for people.
  std::string stop_reason;            ///< Empty unless done.
  std::optional<Eigen::Vector3d> target_W;
};
double PathLength(const Plan& plan);  ///< [m]

/// A plan that is being carried out, and what it was made for.
struct Task {
  Plan plan;
  std::vector<double> clearance;   ///< [m] From occupied voxels, of each segment of its path.
  std::vector<bool> narrow;        ///< Of each pose of the path, see FacedPath.
  std::vector<VoxelIndex> target;  ///< Voxels to be seen; see Aim.
  Choice choice;                   ///< Without a path when it needed none.
  bool turn_first = false;         ///< Before it sets out, see FacedPath.

  /// Takes a target, unknown voxels and doubtful ones.
  void Aim(std::vector<VoxelIndex> at, const PlanningMap& map);
  void DropTarget();
  /// "3 unknown voxels", "2 doubtful voxels", "3 unknown and 2 doubtful voxels".
  std::string TargetText() const;
  /// Takes a path up, measuring its clearance, as far as `enough` [m].
  void Follow(FacedPath path, const PlanningMap& map, double enough);
  /// Whether what lies ahead of a robot on the path keeps `least` [m] from what is occupied, or what it kept
  /// when it was planned.
  bool StillClear(const PlanningMap& map, const Eigen::Vector3d& p_W, double least) const;
  /// Whether a robot on the path is turned as it must be there. At the path's beginning that is not asked: it
  /// has turned, and asking would keep it there.
  bool FacesNarrowWay(const RigidTransform& T_WB) const;
  /// [voxels] Of the target, those that are known now; of those that were only doubtful, for sure.
  std::size_t KnownOfTarget(const PlanningMap& map) const;

 private:
  std::vector<bool> was_doubtful_;  ///< Of each voxel of the target.
};

}  // namespace thalweg::explorer
