#include "services/explorer/adapter/text.h"

#include <spdlog/fmt/fmt.h>

#include <vector>

#include "common/base/check.h"
#include "common/geometry/point_text.h"
#include "services/explorer/text/outcome_text.h"

namespace thalweg::explorer {
namespace {

constexpr double kTurning = 0.05;  // [m] A plan with a shorter path only turns the robot.
constexpr std::size_t kNamedWays = 3;

/// Formats the target as "3 unknown voxels", "2 doubtful voxels" or "3 unknown and 2 doubtful voxels".
std::string TargetText(const Plan& plan) {
  const auto voxels = [](std::size_t count) { return count == 1 ? "voxel" : "voxels"; };
  if (plan.target_doubtful == 0)
    return fmt::format("{} unknown {}", plan.target_unknown, voxels(plan.target_unknown));
  if (plan.target_unknown == 0)
    return fmt::format("{} doubtful {}", plan.target_doubtful, voxels(plan.target_doubtful));
  return fmt::format("{} unknown and {} doubtful {}", plan.target_unknown, plan.target_doubtful,
                     voxels(plan.target_doubtful));
}

std::string FrontiersText(const Plan& plan) {
  return plan.frontiers == 1 ? "the last frontier known" : fmt::format("one of {} frontiers", plan.frontiers);
}

double AreaOf(const std::vector<Ending::TightWay>& ways) {
  double area = 0.0;
  for (const Ending::TightWay& way : ways) area += way.area;
  return area;
}

std::string TightWaysText(const std::vector<Ending::TightWay>& ways) {
  std::vector<std::string> places;
  for (const Ending::TightWay& way : ways) {
    if (places.size() < kNamedWays) places.push_back(PointText(way.place_W));
  }
  if (ways.size() > kNamedWays) places.push_back(fmt::format("{} more", ways.size() - kNamedWays));
  return fmt::format(
      "{:.2f} m2 of it can be seen only through {} too narrow for the robot's paths, given "
      "explorer.safety_margin_m and mapper.voxel_size_m: {}",
      AreaOf(ways), ways.size() == 1 ? "a gap" : "gaps", fmt::join(places, ", "));
}

std::string SideText(ShutIn::Side side) {
  switch (side) {
    case ShutIn::Side::kBelow:
      return "below it";
    case ShutIn::Side::kAbove:
      return "above it";
    case ShutIn::Side::kBeside:
      break;
  }
  return "beside it";
}

std::string ShutInText(const ShutIn& why) {
  std::string text =
      fmt::format("the robot keeps {:.2f} m (robot.radius_m {:.2f} + explorer.safety_margin_m {:.2f})",
                  why.needed, why.radius, why.needed - why.radius);
  if (why.here < why.needed) {
    text += fmt::format(", and an obstacle {} leaves {:.2f} m where it stands", SideText(why.side), why.here);
    if (why.here < why.radius) {
      text += why.side == ShutIn::Side::kBelow
                  ? ": does it start too near to the floor? The body of one that drives must float a voxel "
                    "above it"
                  : ": does the camera see the robot itself (robot.camera_position_m, mapper.min_range_m)?";
    }
  }
  if (why.fitting) return text + fmt::format("; with {:.2f} m it could go on", *why.fitting);
  return text + "; nor could a smaller one go on: what it has seen around it is closed";
}

std::string PurposeText(const Plan& plan) {
  switch (plan.purpose) {
    case Purpose::kFindFreeSpace:
      return "turning: no free space is known around the robot yet";
    case Purpose::kLookAround:
      return fmt::format("looking around: {} in view", TargetText(plan));
    case Purpose::kSeeFrontier:
      return fmt::format("{} to see {}, {}",
                         plan.length < kTurning ? "turning" : fmt::format("going {:.1f} m", plan.length),
                         TargetText(plan), FrontiersText(plan));
    case Purpose::kTakeView:
      return fmt::format("{} to look at the surface at {}",
                         plan.length < kTurning ? "turning" : fmt::format("going {:.1f} m", plan.length),
                         PointText(*plan.target_W));
    case Purpose::kInspect:
      return fmt::format("{} to inspect {:.1f} m2 of surface",
                         plan.length < kTurning ? "turning" : fmt::format("going {:.1f} m", plan.length),
                         plan.inspects);
    case Purpose::kGoBack:
      return fmt::format("going back {:.1f} m the way it came, since the map shows no other way out",
                         plan.length);
    case Purpose::kGoHome:
      return fmt::format("going home, {:.1f} m: {}", plan.length, OutcomeText(*plan.homeward));
    case Purpose::kGoTo:
      return fmt::format("going {:.1f} m to {}, as commanded", plan.length, PointText(*plan.target_W));
    case Purpose::kLookAt:
      return fmt::format("{} to look at {}, as commanded",
                         plan.length < kTurning ? "turning" : fmt::format("going {:.1f} m", plan.length),
                         PointText(*plan.target_W));
    case Purpose::kWatchShutWay:
      return fmt::format("{} a way that was open and is shut at {}",
                         plan.length < kTurning ? "watching" : fmt::format("going {:.1f} m to", plan.length),
                         PointText(*plan.target_W));
    case Purpose::kLeaveNoGo:
      return fmt::format("leaving a no-go box, {:.1f} m", plan.length);
    case Purpose::kEnd:
      break;
  }
  return {};
}

}  // namespace

std::string DetailsText(const Ending& ending, double sensor_range) {
  std::vector<std::string> details;
  if (ending.left_out > 0) {
    details.push_back(fmt::format("{} {} left out, where the map did not let the robot look from",
                                  ending.left_out, ending.left_out == 1 ? "pose was" : "poses were"));
  }
  if (ending.outcome == Outcome::kNothingReachable)
    details.push_back(ending.shut_in ? ShutInText(*ending.shut_in) : "no path leads out of the no-go boxes");
  if (ending.misfit_W)
    details.push_back(fmt::format("one can go around what stands at {}", PointText(*ending.misfit_W)));
  if (ending.outcome == Outcome::kNoFreeSpace) {
    details.emplace_back(
        "do clouds arrive, in camera_optical_frame with z forward, and is robot.camera_position_m right?");
  }
  if (ending.doubtful_voxels > 0)
    details.push_back(fmt::format("{} known voxels stayed doubtful", ending.doubtful_voxels));
  if (ending.surface) {
    details.push_back(fmt::format("{:.1f} m2 of {:.1f} m2 of surface were inspected, as voxels count it",
                                  ending.surface->inspected, ending.surface->all));
  }
  if (ending.left_frontiers > 0) {
    details.push_back(fmt::format("{} {}, {:.2f} m2 in all, {} not worth the path", ending.left_frontiers,
                                  ending.left_frontiers == 1 ? "frontier" : "frontiers", ending.left_area,
                                  ending.left_frontiers == 1 ? "was" : "were"));
  }
  if (ending.missed.empty() && ending.missed_area > 0.0) {
    details.push_back(
        fmt::format("{:.2f} m2 of frontier stayed unknown, {:.1f} % of the border of free space",
                    ending.missed_area, 100.0 * ending.missed_share));
  }
  if (!ending.missed.empty()) {
    std::vector<std::string> areas;
    for (const auto& [reason, area] : ending.missed)
      areas.push_back(fmt::format("{:.2f} m2 {}", area, AsideText(reason, false)));
    details.push_back(
        fmt::format("{:.2f} m2 of frontier stayed unknown, {:.1f} % of the border of free space: {}",
                    ending.missed_area, 100.0 * ending.missed_share, fmt::join(areas, ", ")));
    if (ending.hidden_area > 0.0) {
      details.push_back(
          fmt::format("{:.2f} m2 of it are hidden by unknown space that bars the path", ending.hidden_area));
    }
    if (ending.shut_area > 0.0) {
      std::vector<std::string> places;
      for (const Eigen::Vector3d& place_W : ending.shut_ways_W) places.push_back(PointText(place_W));
      details.push_back(fmt::format("{:.2f} m2 of it are behind {} and shut at the end: {}", ending.shut_area,
                                    places.size() == 1 ? "a way that was open" : "ways that were open",
                                    fmt::join(places, ", ")));
    }
    if (!ending.tight_ways.empty()) details.push_back(TightWaysText(ending.tight_ways));
    const bool mostly_tight = AreaOf(ending.tight_ways) > 0.5 * ending.missed_area;
    if (ending.outcome == Outcome::kTooMuchUnknown && !mostly_tight) {
      details.push_back(
          fmt::format("does the sensor's range of {:.1f} m end before the surfaces do?", sensor_range));
    }
  }
  return fmt::format("{}", fmt::join(details, "; "));
}

std::string PlanText(const Plan& plan, double sensor_range) {
  if (plan.ending) {
    const std::string details = DetailsText(*plan.ending, sensor_range);
    return "done: " + EndingText(*plan.ending) + (details.empty() ? "" : "; " + details);
  }
  const std::string text = PurposeText(plan);
  return plan.faces_passage_first ? "turning to the narrow passage ahead, then " + text : text;
}

std::string AnswerText(const Answer& answer) {
  return answer.ended ? answer.text + ": " + EndingText(*answer.ended) : answer.text;
}

std::string PauseText(const PauseCause& cause) {
  switch (cause.reason) {
    case PauseReason::kOperator:
      return "by the operator";
    case PauseReason::kStepDone:
      return "one decision was carried out";
    case PauseReason::kStepInterrupted:
      return "the decision was interrupted";
    case PauseReason::kErrandDone:
      return "the robot has done what was commanded";
    case PauseReason::kErrandImpossible:
      return "what was commanded is no longer possible: " + cause.error;
    case PauseReason::kEnded:
      return "the exploration has ended";
    case PauseReason::kRestarted:
      break;
  }
  return "the explorer was restarted during a command";
}

std::string_view InterruptionText(Interruption interruption) {
  switch (interruption) {
    case Interruption::kPathBlocked:
      return "the path is no longer clear";
    case Interruption::kNotFacingPassage:
      return "the robot does not face the narrow passage it enters";
    case Interruption::kTimeForHome:
      return "the rest of the time budget is needed to get home";
    case Interruption::kDistanceForHome:
      return "the rest of the distance budget is needed to get home";
    case Interruption::kTargetSeen:
      return "the target was seen on the way";
    case Interruption::kClockReset:
      return "the clock went back";
    case Interruption::kLost:
      return "the robot was lost on the way";
    case Interruption::kControllerStopped:
      return "the controller stopped before the end of the path";
    case Interruption::kMapReplaced:
      return "the mapper sent a whole map";
    case Interruption::kOperator:
      return "an operator's command";
    case Interruption::kMapSilent:
      return "no scan has reached the map for a while";
  }
  THALWEG_CHECK(false);
  return {};
}

std::string ActivityText(const ExplorationLoop& loop, double sensor_range) {
  if (loop.state() == LoopState::kPaused) return "paused: " + PauseText(loop.pause_cause());
  switch (loop.awaited()) {
    case Awaited::kMap:
      return "waiting for a map";
    case Awaited::kOdometry:
      return "waiting for odometry";
    case Awaited::kScan:
      return "waiting for a scan";
    case Awaited::kNextScan:
      return "waiting for a scan, since none has reached the map for a while";
    case Awaited::kView:
      return "waiting for a view of the camera: an organized cloud, and odometry at its stamp";
    case Awaited::kNothing:
      break;
  }
  return PlanText(loop.plan(), sensor_range);
}

}  // namespace thalweg::explorer
