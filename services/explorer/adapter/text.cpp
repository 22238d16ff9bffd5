#include "services/explorer/adapter/text.h"

#include <spdlog/fmt/fmt.h>

namespace thalweg::explorer {
namespace {

constexpr double kTurning = 0.05;  // [m] A plan with a shorter path only turns the robot.

/// Formats the target as "3 unknown voxels", "2 doubtful voxels" or "3 unknown and 2 doubtful voxels".
std::string TargetText(const Plan& plan) {
  if (plan.target_doubtful == 0) return fmt::format("{} unknown voxels", plan.target_unknown);
  if (plan.target_unknown == 0) return fmt::format("{} doubtful voxels", plan.target_doubtful);
  return fmt::format("{} unknown and {} doubtful voxels", plan.target_unknown, plan.target_doubtful);
}

std::string FrontiersText(const Plan& plan) {
  return plan.frontiers == 1 ? "the last frontier known" : fmt::format("one of {} frontiers", plan.frontiers);
}

std::string EndingText(const Ending& ending, double sensor_range) {
  std::string text = "done: " + ToText(ending);
  if (ending.doubtful_voxels > 0)
    text += fmt::format("; {} known voxels stayed doubtful", ending.doubtful_voxels);
  if (ending.missed.empty()) return text;
  text += fmt::format("; {:.2f} m2 of frontier stayed unknown, {:.1f} % of the border of free space",
                      ending.missed_area, 100.0 * ending.missed_share);
  const char* separator = ": ";
  for (const auto& [reason, area] : ending.missed) {
    const std::string_view why = reason == AsideReason::kNone ? "too small" : ToText(reason);
    text += fmt::format("{}{:.2f} m2 {}", separator, area, why);
    separator = ", ";
  }
  if (ending.outcome == Outcome::kTooMuchUnknown) {
    text += fmt::format("; does the sensor's range of {:.1f} m end before the surfaces do?", sensor_range);
  }
  return text;
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
    case Purpose::kGoHome:
      return fmt::format("going home, {:.1f} m: {}", plan.length, ToText(*plan.homeward));
    case Purpose::kGoTo:
      return fmt::format("going {:.1f} m to {}, as commanded", plan.length, PointText(*plan.target_W));
    case Purpose::kLookAt:
      return fmt::format("{} to look at {}, as commanded",
                         plan.length < kTurning ? "turning" : fmt::format("going {:.1f} m", plan.length),
                         PointText(*plan.target_W));
    case Purpose::kLeaveNoGo:
      return fmt::format("leaving a no-go box, {:.1f} m", plan.length);
    case Purpose::kEnd:
      break;
  }
  return {};
}

}  // namespace

std::string PlanText(const Plan& plan, double sensor_range) {
  if (plan.ending) return EndingText(*plan.ending, sensor_range);
  const std::string text = PurposeText(plan);
  return plan.faces_passage_first ? "turning to the narrow passage ahead, then " + text : text;
}

std::string ActivityText(const ExplorationLoop& loop, double sensor_range) {
  if (loop.state() == LoopState::kPaused) return "paused: " + loop.pause_reason();
  switch (loop.awaited()) {
    case Awaited::kMap:
      return "waiting for a map";
    case Awaited::kOdometry:
      return "waiting for odometry";
    case Awaited::kScan:
      return "waiting for a scan";
    case Awaited::kNothing:
      break;
  }
  return PlanText(loop.plan(), sensor_range);
}

}  // namespace thalweg::explorer
