#include "services/controller/adapter/options.h"

#include <stdexcept>
#include <string>

#include "common/geometry/angles.h"

namespace thalweg::controller {

ControllerOptions OptionsFrom(const Scenario& scenario) {
  ControllerOptions options;
  const RobotModel robot = RobotFrom(scenario);
  options.follower.max_speed = robot.max_speed;
  options.follower.max_acceleration = robot.max_acceleration;
  options.follower.max_turn_rate = robot.max_turn_rate;
  const Controller& given = scenario.controller();
  if (given.has_rate_hz()) options.rate = given.rate_hz();
  if (given.has_silence_s()) options.follower.silence = given.silence_s();
  if (given.has_position_tolerance_m()) options.follower.position_tolerance = given.position_tolerance_m();
  if (given.has_angle_tolerance_deg()) {
    options.follower.angle_tolerance = given.angle_tolerance_deg() * kDegree;
  }
  if (!(options.rate >= 1.0 && options.rate <= 1000.0)) {
    throw std::invalid_argument("controller.rate_hz = " + std::to_string(options.rate) +
                                ", allowed: 1 to 1000");
  }
  return options;
}

}  // namespace thalweg::controller
