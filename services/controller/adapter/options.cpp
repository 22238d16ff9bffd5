#include "services/controller/adapter/options.h"

#include <algorithm>
#include <cmath>

#include "common/base/text.h"
#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"
#include "services/controller/core/braking_time.h"

namespace thalweg::controller {

void Visit(OptionVisitor& visitor, ControllerOptions& options) {
  visitor.Number("rate_hz", options.rate);
  visitor.Number("silence_s", options.follower.silence);
  visitor.Number("position_tolerance_m", options.follower.position_tolerance);
  visitor.Degrees("angle_tolerance_deg", options.follower.angle_tolerance);
  visitor.Choice("on_cut_off", options.follower.cut_off.action,
                 {{"STAND", OnCutOff::kStand},
                  {"RETREAT", OnCutOff::kRetreat},
                  {"HOME", OnCutOff::kHome},
                  {"GO_ON", OnCutOff::kGoOn}});
  visitor.Number("cut_off_after_s", options.follower.cut_off.after);
  visitor.Number("retreat_step_m", options.follower.cut_off.step);
  visitor.Switch("check_paths", options.check_paths);
  visitor.Choice(
      "type", options.type,
      {{"PATH_FOLLOWER", ControllerType::kPathFollower}, {"STOP_AND_TURN", ControllerType::kStopAndTurn}});
}

ControllerOptions OptionsFrom(const Scenario& scenario) {
  ControllerOptions options;
  const RobotModel robot = RobotFrom(scenario);
  options.follower.robot = robot;
  options.pose_gate.max_speed = robot.max_speed;
  options.pose_gate.max_turn_rate = robot.greatest_turn_rate();
  ReadOptions(scenario.controller(), options);
  if (options.follower.cut_off.action == OnCutOff::kGoOn) options.check_paths = true;
  if (options.check_paths) {
    options.follower.checked_body =
        PathCheck::Body{.radius = robot.radius, .height = robot.height, .drives = robot.drives};
  }
  return options;
}

std::vector<Mistake> MistakesIn(const Scenario& scenario) {
  std::vector<Mistake> mistakes;
  const ControllerOptions controller = OptionsFrom(scenario);
  const PathFollower::Options& options = controller.follower;
  if (options.cut_off.after < options.silence) {
    const FieldPath silence = PathOf("controller", "silence_s");
    mistakes.push_back({.field = PathOf("controller", "cut_off_after_s"),
                        .text = "is " + NumberText(options.cut_off.after) + ", must be at least " +
                                ToString(silence) + ", " + NumberText(options.silence) + " s",
                        .other = silence});
  }
  // A robot with limited jerk takes longer to stop. Paths are repeated ten times a second, and come late.
  const double stop = BrakingTime(options.robot) / options.emergency_factor + options.robot.smoothing() +
                      2.0 / controller.rate + std::max(0.1, options.delay);
  if (options.robot.smoothing() > 0.0 && options.silence < stop) {
    const FieldPath jerk = PathOf("robot", "max_jerk_mps3");
    mistakes.push_back({.field = PathOf("controller", "silence_s"),
                        .text = "is " + NumberText(options.silence) + ", must be at least " +
                                NumberText(std::ceil(stop * 100.0) / 100.0) + " s with this " +
                                ToString(jerk) + ": a robot at its greatest speed takes that long to stop",
                        .other = jerk});
  }
  const bool unchecked = scenario.controller().has_check_paths() && !scenario.controller().check_paths();
  if (options.cut_off.action == OnCutOff::kGoOn && unchecked) {
    const FieldPath action = PathOf("controller", "on_cut_off");
    mistakes.push_back({.field = PathOf("controller", "check_paths"),
                        .text = "is false, must be true for a robot whose " + ToString(action) + " is GO_ON",
                        .other = action});
  }
  return mistakes;
}

}  // namespace thalweg::controller
