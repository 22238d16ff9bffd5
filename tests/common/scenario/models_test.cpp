#include "common/scenario/models.h"

#include <gtest/gtest.h>

#include <numbers>

namespace thalweg {
namespace {

TEST(RobotFrom, KeepsTheDefaultsOfWhatIsAbsent) {
  const RobotModel standard;
  const RobotModel robot = RobotFrom(Scenario());
  EXPECT_EQ(robot.radius, standard.radius);
  EXPECT_EQ(robot.max_speed, standard.max_speed);
  EXPECT_EQ(robot.max_turn_rate, standard.max_turn_rate);
  EXPECT_TRUE(robot.T_BC.isApprox(standard.T_BC));
}

TEST(RobotFrom, TurnsDegreesIntoRadiansAndTiltsTheCamera) {
  Scenario scenario;
  scenario.mutable_robot()->set_max_turn_rate_dps(90.0);
  scenario.mutable_robot()->set_max_turn_acceleration_dps2(180.0);
  scenario.mutable_robot()->set_camera_pitch_deg(-30.0);
  scenario.mutable_robot()->mutable_camera_position_m()->set_x(0.1);
  const RobotModel robot = RobotFrom(scenario);
  EXPECT_NEAR(robot.max_turn_rate, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(robot.max_turn_acceleration, std::numbers::pi, 1e-12);
  EXPECT_NEAR((robot.T_BC.linear() * Eigen::Vector3d::UnitZ()).z(), -0.5, 1e-12);  // looks down
  EXPECT_EQ(robot.T_BC.translation().x(), 0.1);
}

TEST(DepthSensorFrom, KeepsTheDefaultsOfWhatIsAbsent) {
  const DepthSensorModel standard;
  const DepthSensorModel sensor = DepthSensorFrom(Scenario());
  EXPECT_EQ(sensor.camera.width_px, standard.camera.width_px);
  EXPECT_NEAR(sensor.camera.fx, standard.camera.fx, 1e-9);
  EXPECT_EQ(sensor.rate, standard.rate);
  EXPECT_EQ(sensor.max_range, standard.max_range);
}

TEST(DepthSensorFrom, AFinerImageKeepsItsFieldOfView) {
  Scenario scenario;
  scenario.mutable_depth_sensor()->set_width_px(512);
  scenario.mutable_depth_sensor()->set_height_px(384);
  const PinholeCamera camera = DepthSensorFrom(scenario).camera;
  const PinholeCamera standard = DepthSensorModel{}.camera;
  EXPECT_EQ(camera.width_px, 512);
  EXPECT_NEAR(camera.width_px / camera.fx, standard.width_px / standard.fx, 1e-12);
}

TEST(DepthErrorFrom, IsTheDepthSensorsNoiseUnlessItIsStatedOrDepthComesFromElsewhere) {
  Scenario scenario;
  EXPECT_EQ(DepthErrorFrom(scenario).sigma, 0.0);
  scenario.mutable_depth_sensor()->set_disparity_noise_px(0.5);
  const DepthSensorModel sensor = DepthSensorFrom(scenario);
  EXPECT_DOUBLE_EQ(DepthErrorFrom(scenario).sigma, 0.5 / (sensor.camera.fx * sensor.baseline));
  scenario.mutable_depth_sensor()->set_image_noise_px(1.2);
  EXPECT_DOUBLE_EQ(DepthErrorFrom(scenario).sigma, 1.3 / (sensor.camera.fx * sensor.baseline));
  scenario.set_depth_source(DepthSource::STEREO);
  EXPECT_EQ(DepthErrorFrom(scenario).sigma, 0.0) << "the sensor's noise says nothing of images";
  scenario.mutable_mapper()->set_depth_error_per_m(0.003);
  EXPECT_EQ(DepthErrorFrom(scenario).sigma, 0.003);
}

}  // namespace
}  // namespace thalweg
