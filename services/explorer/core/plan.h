#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/rigid_transform.h"
#include "services/explorer/core/outcome.h"

namespace thalweg::explorer {

/// What a plan is for.
enum class Purpose : std::uint8_t {
  kFindFreeSpace,  ///< Turn on the spot, because no free space is known at the robot yet.
  kLookAround,     ///< Turn to unknown voxels that are in sight from here.
  kSeeFrontier,    ///< Go, or turn, to see a frontier.
  kTakeView,       ///< Go, or turn, to look at the surface, for a strategy that goes by views.
  kInspect,        ///< Go, or turn, to see surface from near and squarely enough.
  kWatchShutWay,   ///< Go, or turn, to see whether a way that was open is open again.
  kGoBack,         ///< Go back the way the robot came, because it is shut in.
  kGoHome,
  kGoTo,       ///< Go where an operator sent the robot.
  kLookAt,     ///< Look where an operator pointed.
  kLeaveNoGo,  ///< Leave a no-go box that was drawn around the robot.
  kEnd,        ///< See Plan::ending.
};

/// What the robot does next.
struct Plan {
  enum class Kind : std::uint8_t {
    kLook,  ///< Turn on the spot and scan.
    kGo,    ///< Follow a path and face the unknown at its end.
    kDone,  ///< See `ending`.
  };
  Kind kind = Kind::kDone;
  Purpose purpose = Purpose::kEnd;
  std::vector<RigidTransform> T_WBs;  ///< Path of the body, starting at its present pose; empty when done.
  std::optional<Eigen::Vector3d> target_W;  ///< [m] A point to show to people.

  /// The robot only turns to the narrow passage ahead; the plan for the purpose follows afterwards.
  bool faces_passage_first = false;
  Duration dwell{};                ///< The robot stays at the end for so long before the next decision.
  double length = 0.0;             ///< [m] Length of the path, or of the path that follows such a turn.
  std::size_t target_unknown = 0;  ///< Number of unknown voxels that the plan is to show.
  std::size_t target_doubtful = 0;
  double inspects = 0.0;            ///< [m^2] Surface that the plan is to inspect.
  std::size_t frontiers = 0;        ///< Number of clusters among which it was chosen.
  std::vector<std::string> notes;   ///< What the strategy says of how it came to the plan.
  std::optional<Outcome> homeward;  ///< Why the robot is on its way home, or has ended there.
  std::optional<Ending> ending;     ///< When done.
};
}  // namespace thalweg::explorer
