#include "services/controller/adapter/options.h"

#include <gtest/gtest.h>

#include <numbers>

namespace thalweg::controller {
namespace {

TEST(ControllerOptions, WhatTheScenarioDoesNotSayIsTheCoresDefault) {
  const ControllerOptions options = OptionsFrom(Scenario{});
  const PathFollower::Options defaults;
  EXPECT_EQ(options.follower.silence, defaults.silence);
  EXPECT_EQ(options.follower.position_tolerance, defaults.position_tolerance);
  EXPECT_EQ(options.follower.max_speed, RobotModel{}.max_speed);
}

TEST(ControllerOptions, ScenarioWins) {
  Scenario scenario;
  scenario.mutable_robot()->set_max_speed_mps(1.25);
  scenario.mutable_controller()->set_silence_s(0.75);
  scenario.mutable_controller()->set_angle_tolerance_deg(10.0);
  scenario.mutable_controller()->set_rate_hz(100.0);
  const ControllerOptions options = OptionsFrom(scenario);
  EXPECT_DOUBLE_EQ(options.follower.max_speed, 1.25);
  EXPECT_DOUBLE_EQ(options.follower.silence, 0.75);
  EXPECT_DOUBLE_EQ(options.follower.angle_tolerance, std::numbers::pi / 18.0);
  EXPECT_DOUBLE_EQ(options.rate, 100.0);
}

TEST(ControllerOptions, RefusesARateOfZero) {
  Scenario scenario;
  scenario.mutable_controller()->set_rate_hz(0.0);
  EXPECT_THROW(OptionsFrom(scenario), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::controller
