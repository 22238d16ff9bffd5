#include "services/gateway/adapter/parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "common/scenario/models.h"

namespace thalweg::gateway {
namespace {

std::optional<std::string> ValueOf(const Scenario& scenario, const std::string& name) {
  const std::vector<Parameter> all = ParametersOf(scenario);
  const auto found = std::ranges::find(all, name, &Parameter::name);
  return found == all.end() ? std::nullopt : std::optional(found->value);
}

double NumberOf(const Scenario& scenario, const std::string& name) {
  const std::optional<std::string> text = ValueOf(scenario, name);
  EXPECT_TRUE(text) << name;
  return text ? std::stod(*text) : 0.0;
}

TEST(ParametersOf, AScenarioThatSaysNothingOfTheRobotHasItsDefaults) {
  const Scenario silent;
  const RobotModel robot;
  const PinholeCamera camera = DepthSensorModel{}.camera;
  EXPECT_NEAR(NumberOf(silent, "robot.radius_m"), robot.radius, 1e-6);
  EXPECT_NEAR(NumberOf(silent, "robot.height_m"), robot.height, 1e-6);
  EXPECT_EQ(NumberOf(silent, "depth_sensor.width_px"), camera.width_px);
  EXPECT_EQ(NumberOf(silent, "depth_sensor.height_px"), camera.height_px);
  EXPECT_NEAR(NumberOf(silent, "depth_sensor.horizontal_fov_deg"),
              2.0 * std::atan(0.5 * camera.width_px / camera.fx) / kDegree, 1e-4);
  EXPECT_NEAR(NumberOf(silent, "mapper.voxel_size_m"), MapModel{}.voxel_size, 1e-6);
  EXPECT_EQ(ValueOf(silent, "depth_source"), "DEPTH_SENSOR");
}

TEST(ParametersOf, WhatIsSetStaysAndAListIsNumbered) {
  Scenario scenario;
  scenario.mutable_robot()->set_radius_m(0.3);
  scenario.mutable_world()->add_no_go()->mutable_max_m()->set_y(2.5);
  EXPECT_EQ(NumberOf(scenario, "robot.radius_m"), 0.3);
  EXPECT_EQ(NumberOf(scenario, "world.no_go.0.max_m.y"), 2.5);
  EXPECT_FALSE(ValueOf(Scenario(), "world.no_go.0.max_m.y"));
}

}  // namespace
}  // namespace thalweg::gateway
