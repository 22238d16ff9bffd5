#include "services/controller/adapter/text.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "common/base/angles.h"
#include "common/base/check.h"
#include "common/base/duration_text.h"
#include "common/geometry/point_text.h"

namespace thalweg::controller {
namespace {

std::string_view ToText(BackPlace place) {
  switch (place) {
    case BackPlace::kLastHeard:
      return "where the explorer was last heard";
    case BackPlace::kFartherBack:
      return "farther back on the path that it came";
    case BackPlace::kBeginning:
      return "where it began";
    case BackPlace::kFarthestRemembered:
      break;
  }
  return "as far back as it remembers";
}

std::string ThroughSolidText(const std::optional<Eigen::Vector3d>& obstacle_W) {
  THALWEG_CHECK(obstacle_W.has_value());
  return "path leads through what is known to be solid at " + PointText(*obstacle_W);
}

std::string BackText(std::string_view what, const std::optional<BackPlace>& place) {
  THALWEG_CHECK(place.has_value());
  return fmt::format("path silent: {} {}", what, ToText(*place));
}

}  // namespace

std::string ReasonText(const Motion& motion) {
  switch (motion.reason) {
    case StopReason::kNone:
      break;
    case StopReason::kNoPath:
      return "no path yet";
    case StopReason::kNoPose:
      return "no pose yet";
    case StopReason::kNoMap:
      return "no map yet to check the path with";
    case StopReason::kEmptyPath:
      return "empty path";
    case StopReason::kPathSilent:
      return "path silent";
    case StopReason::kGoingOn:
      return "path silent: going on to its end, as the map on board allows";
    case StopReason::kGoingBack:
      return BackText("going back to", motion.back);
    case StopReason::kWentBack:
      return BackText("went back, waiting", motion.back);
    case StopReason::kPoseSilent:
      return "pose silent";
    case StopReason::kLost:
      return "lost";
    case StopReason::kRetreating:
      return "lost: retreating to the last known poses";
    case StopReason::kOffPath:
      return "off the path";
    case StopReason::kThroughSolid:
      return ThroughSolidText(motion.obstacle_W);
    case StopReason::kBlocked:
      return "blocked: the robot does not follow";
    case StopReason::kWaitingForArrival:
      return "waiting for the robot to arrive";
  }
  return {};
}

std::string JumpText(const PoseGate::Jump& jump) {
  return fmt::format(
      "jumps by {:.2f} m and {:.0f} deg within {:.2f} s, faster than the robot moves; believed if it stays "
      "there",
      jump.distance, jump.turn / kDegree, jump.time);
}

}  // namespace thalweg::controller
