#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "services/explorer/core/outcome.h"

namespace thalweg::explorer {

/// What a plan is for.
enum class Purpose : std::uint8_t {
  kFindFreeSpace,  ///< Turn on the spot: nothing free is known at the robot yet.
  kLookAround,     ///< Turn to unknown voxels that are in sight from here.
  kSeeFrontier,    ///< Go, or turn, to see a frontier.
  kGoHome,
  kEnd,  ///< See Plan::ending.
};

/// What to do next.
struct Plan {
  enum class Kind : std::uint8_t {
    kLook,  ///< Turn on the spot and scan.
    kGo,    ///< Follow a path, facing the unknown at its end.
    kDone,  ///< See ending.
  };
  Kind kind = Kind::kDone;
  Purpose purpose = Purpose::kEnd;
  std::vector<RigidTransform> T_WBs;        ///< Path of the body, its present pose first; empty when done.
  std::optional<Eigen::Vector3d> target_W;  ///< [m] A point to show to people.

  /// The robot only turns to the narrow passage ahead; what follows is the plan for the purpose.
  bool faces_passage_first = false;
  double length = 0.0;             ///< [m] Of the path, also of the one that follows such a turn.
  std::size_t target_unknown = 0;  ///< Unknown voxels that it is to show.
  std::size_t target_doubtful = 0;
  std::size_t frontiers = 0;        ///< Clusters among which it was chosen.
  std::optional<Outcome> homeward;  ///< Why the robot is on its way home, or ended there.
  std::optional<Ending> ending;     ///< When done.
};
}  // namespace thalweg::explorer
