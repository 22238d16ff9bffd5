#include "services/controller/adapter/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace thalweg::controller {
namespace {

TEST(ControllerOptions, WhatTheScenarioDoesNotSayIsTheCoresDefault) {
  const ControllerOptions options = OptionsFrom(Scenario{});
  const PathFollower::Options defaults;
  EXPECT_EQ(options.follower.silence, defaults.silence);
  EXPECT_EQ(options.follower.position_tolerance, defaults.position_tolerance);
  EXPECT_EQ(options.follower.robot.max_speed, RobotModel{}.max_speed);
  EXPECT_EQ(options.type, ControllerType::kPathFollower);
}

TEST(ControllerOptions, ScenarioWins) {
  Scenario scenario;
  scenario.mutable_robot()->set_max_speed_mps(1.25);
  scenario.mutable_controller()->set_silence_s(0.75);
  scenario.mutable_controller()->set_angle_tolerance_deg(10.0);
  scenario.mutable_controller()->set_rate_hz(100.0);
  scenario.mutable_controller()->set_type(Controller::STOP_AND_TURN);
  const ControllerOptions options = OptionsFrom(scenario);
  EXPECT_DOUBLE_EQ(options.follower.robot.max_speed, 1.25);
  EXPECT_DOUBLE_EQ(options.follower.silence, 0.75);
  EXPECT_DOUBLE_EQ(options.follower.angle_tolerance, std::numbers::pi / 18.0);
  EXPECT_DOUBLE_EQ(options.rate, 100.0);
  EXPECT_EQ(options.type, ControllerType::kStopAndTurn);
}

TEST(ControllerOptions, TheScenarioSaysWhatTheRobotDoesWhenItIsCutOffAndWhetherPathsAreChecked) {
  Scenario scenario;
  scenario.mutable_robot()->set_radius_m(0.3);
  scenario.mutable_controller()->set_on_cut_off(Controller::RETREAT);
  scenario.mutable_controller()->set_cut_off_after_s(7.0);
  scenario.mutable_controller()->set_retreat_step_m(1.5);
  scenario.mutable_controller()->set_check_paths(true);
  const ControllerOptions options = OptionsFrom(scenario);
  EXPECT_EQ(options.follower.cut_off.action, OnCutOff::kRetreat);
  EXPECT_DOUBLE_EQ(options.follower.cut_off.after, 7.0);
  EXPECT_DOUBLE_EQ(options.follower.cut_off.step, 1.5);
  ASSERT_TRUE(options.follower.checked_body);
  EXPECT_DOUBLE_EQ(options.follower.checked_body->radius, 0.3);
  EXPECT_FALSE(OptionsFrom(Scenario{}).follower.checked_body)
      << "where the mapper is far away, a map costs a link";
}

TEST(ControllerMistakes, ARobotWithLimitedJerkThatCannotStopInTimeIsOne) {
  Scenario scenario;
  scenario.mutable_robot()->set_max_speed_mps(2.0);
  scenario.mutable_robot()->set_max_acceleration_mps2(3.0);
  EXPECT_TRUE(controller::MistakesIn(scenario).empty());
  scenario.mutable_robot()->set_max_jerk_mps3(30.0);
  EXPECT_NEAR(OptionsFrom(scenario).follower.robot.smoothing(), 2.0 * 3.0 / 30.0, 1e-12);
  const std::vector<Mistake> mistakes = controller::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].field), "controller.silence_s");
  EXPECT_EQ(
      mistakes[0].text,
      "is 0.5, must be at least 0.71 s with this robot.max_jerk_mps3: a robot at its greatest speed takes "
      "that long to stop");
  scenario.mutable_controller()->set_silence_s(0.71);
  EXPECT_TRUE(controller::MistakesIn(scenario).empty());
}

TEST(ControllerMistakes, ARobotThatIsCutOffBeforeItsPathIsSilentIsOneEvenAgainstADefault) {
  Scenario scenario;
  EXPECT_TRUE(controller::MistakesIn(scenario).empty());
  scenario.mutable_controller()->set_silence_s(6.0);
  const std::vector<Mistake> mistakes = controller::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].field), "controller.cut_off_after_s");
  EXPECT_EQ(mistakes[0].text, "is 5, must be at least controller.silence_s, 6 s");
  EXPECT_EQ(ToString(mistakes[0].other), "controller.silence_s") << "which alone was given, and has a place";
  scenario.mutable_controller()->set_cut_off_after_s(6.0);
  EXPECT_TRUE(controller::MistakesIn(scenario).empty());
}

TEST(ControllerOptions, ARobotThatGoesOnWhenItIsCutOffChecksItsPaths) {
  Scenario scenario;
  scenario.mutable_controller()->set_on_cut_off(Controller::GO_ON);
  EXPECT_TRUE(OptionsFrom(scenario).check_paths);
  EXPECT_TRUE(OptionsFrom(scenario).follower.checked_body);
  EXPECT_TRUE(controller::MistakesIn(scenario).empty());
  scenario.mutable_controller()->set_check_paths(false);
  const std::vector<Mistake> mistakes = controller::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].field), "controller.check_paths");
  EXPECT_EQ(mistakes[0].text, "is false, must be true for a robot whose controller.on_cut_off is GO_ON");
}

}  // namespace
}  // namespace thalweg::controller
