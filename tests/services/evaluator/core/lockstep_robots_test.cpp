#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "common/base/angles.h"
#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/core/lockstep.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::evaluator {
namespace {

/// The tiny room, flown level within the accelerations.
class DynamicMotion : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  static LockstepResult Fly(const char* minimize, const char* strategy, int seed, const char* jerk = "0") {
    const Scene scene("tiny", {"robot.attitude=LEVEL", "robot.max_speed_mps=2",
                               "robot.max_acceleration_mps2=3", "robot.max_turn_rate_dps=90",
                               "depth_sensor.rate_hz=10", std::string("explorer.minimize=") + minimize,
                               std::string("robot.max_jerk_mps3=") + jerk, "controller.silence_s=1"});
    const LockstepOptions options = scene.Options(strategy, seed, PoseSource::kTruth, MotionModel::kDynamic);
    mapper::OccupancyMap map(options.mapper);
    return RunLockstep(scene.world(), scene.Start(seed), options, map);
  }
};
INSTANTIATE_TEST_SUITE_P(Minimize, DynamicMotion,
                         testing::Combine(testing::Values("PATH", "TIME"),
                                          testing::Values("closest", "cover")));

TEST_P(DynamicMotion, StaysWithinTheLimitsAndExploresAllWithoutACollision) {
  for (int seed = 1; seed <= 3; ++seed) {
    const LockstepResult result = Fly(std::get<0>(GetParam()), std::get<1>(GetParam()), seed);
    EXPECT_EQ(ToText(result.end), "complete") << seed;
    EXPECT_EQ(result.collisions, 0);
    EXPECT_LE(result.motion.most_speed, 2.0 + 1e-6);
    // Corners of the polyline are steps of up to 0.05 m/s, of which 0.1 s may have one more at either end.
    EXPECT_LE(result.motion.most_acceleration, 3.0 + 2.0 * 0.05 / 0.1);
    EXPECT_LE(result.motion.most_turn_rate, 90.0 * kDegree + 1e-3);
    EXPECT_LE(result.motion.most_turn_acceleration, RobotModel{}.max_turn_acceleration + 0.05);
    const MotionFigures& motion = result.motion;
    EXPECT_NEAR(motion.moving + motion.turning + motion.standing, result.duration, 1e-6);
  }
}

TEST(DynamicMotionThatEndsInFlight, GoesOnUntilItStands) {
  const Scene scene("kitchen", {"robot.max_speed_mps=2", "robot.max_acceleration_mps2=3",
                                "explorer.minimize=TIME", "explorer.distance_budget_m=4"});
  const LockstepOptions options = scene.Options("cover", 1, PoseSource::kTruth, MotionModel::kDynamic);
  mapper::OccupancyMap map(options.mapper);
  const LockstepResult result = RunLockstep(scene.world(), scene.Start(1), options, map);
  EXPECT_EQ(ToText(result.end), "distance budget");
  const double step = options.robot.max_speed * options.time_step;
  EXPECT_GT(result.distance, 4.0 + 2.0 * step) << "what it takes to brake";
  EXPECT_LT(result.distance, 4.0 + 2.0 * step + 0.7);
}

TEST_P(DynamicMotion, KeepsTheJerkIfItIsLimited) {
  for (int seed = 1; seed <= 2; ++seed) {
    const LockstepResult result = Fly(std::get<0>(GetParam()), std::get<1>(GetParam()), seed, "30");
    EXPECT_EQ(ToText(result.end), "complete") << seed;
    EXPECT_EQ(result.collisions, 0);
    EXPECT_LE(result.motion.most_speed, 2.0 + 1e-6);
    EXPECT_LE(result.motion.most_acceleration, 3.0 + 2.0 * 0.05 / 0.2);  // such a step takes 0.2 s
    EXPECT_LE(result.motion.most_jerk, 30.0);
  }
}

TEST(GimballedRobot, ExploresAllWithoutRollAndWithinItsLimits) {
  const Scene scene("tiny", {"robot.attitude=GIMBAL", "robot.gimbal_min_pitch_deg=-80",
                             "robot.gimbal_max_pitch_deg=25", "robot.max_gimbal_rate_dps=45"});
  for (const MotionModel motion : {MotionModel::kKinematic, MotionModel::kDynamic}) {
    for (const char* strategy : {"closest", "cover"}) {
      const LockstepOptions options = scene.Options(strategy, 1, PoseSource::kTruth, motion);
      mapper::OccupancyMap map(options.mapper);
      double lowest = 0.0;
      const LockstepResult result =
          RunLockstep(scene.world(), scene.Start(1), options, map, {}, nullptr, {},
                      [&](const auto&, const RigidTransform& T_WC, const auto&) {
                        const Eigen::Matrix3d R_WB = T_WC.linear() * options.robot.T_BC.linear().transpose();
                        EXPECT_NEAR(R_WB(2, 1), 0.0, 1e-6) << "no roll";
                        const double pitch = std::asin(std::clamp(R_WB(2, 0), -1.0, 1.0));
                        EXPECT_GE(pitch, -80.0 * kDegree - 1e-6);
                        EXPECT_LE(pitch, 25.0 * kDegree + 1e-6);
                        lowest = std::min(lowest, pitch);
                      });
      EXPECT_EQ(ToText(result.end), "complete") << strategy;
      EXPECT_EQ(result.collisions, 0);
      EXPECT_LT(lowest, -20.0 * kDegree) << "it makes use of the gimbal";
    }
  }
}

/// A robot with a differential drive in the flat.
class DifferentialDrive : public testing::TestWithParam<std::tuple<MotionModel, const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Motions, DifferentialDrive,
                         testing::Values(std::tuple(MotionModel::kKinematic, "PATH", "closest"),
                                         std::tuple(MotionModel::kDynamic, "PATH", "closest"),
                                         std::tuple(MotionModel::kDynamic, "TIME", "closest"),
                                         std::tuple(MotionModel::kDynamic, "TIME", "cover")));

TEST_P(DifferentialDrive, ExploresAllWithoutMovingAcrossWhereItFaces) {
  const auto& [motion, minimize, strategy] = GetParam();
  const Scene scene("flat_ground",
                    {"robot.drive=DIFFERENTIAL", std::string("explorer.minimize=") + minimize});
  const LockstepOptions options = scene.Options(strategy, 1, PoseSource::kTruth, motion);
  mapper::OccupancyMap map(options.mapper);
  const LockstepResult result = RunLockstep(scene.world(), scene.Start(1), options, map);
  EXPECT_EQ(ToText(result.end), "complete");
  EXPECT_EQ(result.collisions, 0);
  // Half of a corner that belongs to a curve, and as much by which the turn lags behind.
  const double most = motion == MotionModel::kKinematic ? 1e-6 : std::sin(0.2) * options.robot.max_speed;
  EXPECT_LE(result.motion.most_sideways_speed, most);
  EXPECT_GT(result.motion.turning, 1.0);
}

/// A robot in the flat that turns only in curves.
class AckermannDrive : public testing::TestWithParam<std::tuple<MotionModel, const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Motions, AckermannDrive,
                         testing::Values(std::tuple(MotionModel::kKinematic, "PATH", "closest"),
                                         std::tuple(MotionModel::kDynamic, "PATH", "cover"),
                                         std::tuple(MotionModel::kDynamic, "TIME", "cover")));

TEST_P(AckermannDrive, ExploresAllWithoutTurningTighterThanItCan) {
  const auto& [motion, minimize, strategy] = GetParam();
  const Scene scene("flat_ground", {"robot.drive=ACKERMANN", "robot.min_turning_radius_m=0.4",
                                    std::string("explorer.minimize=") + minimize});
  const LockstepOptions options = scene.Options(strategy, 1, PoseSource::kTruth, motion);
  mapper::OccupancyMap map(options.mapper);
  const LockstepResult result = RunLockstep(scene.world(), scene.Start(1), options, map);
  EXPECT_EQ(ToText(result.end), "complete");
  EXPECT_EQ(result.collisions, 0);
  EXPECT_EQ(result.motion.turning, 0.0) << "on the spot";
  EXPECT_LE(result.motion.sharpest_curve, 1.0 / 0.4);
  EXPECT_LE(result.motion.most_sideways_speed, std::sin(0.1) * options.robot.max_speed);
  EXPECT_GT(result.distance, 5.0);
}

TEST(DynamicMotionThatMinimizesTime, TakesLessOfIt) {
  double path = 0.0;
  double time = 0.0;
  for (int seed = 1; seed <= 4; ++seed) {
    for (const auto& [minimize, sum] : {std::pair("PATH", &path), std::pair("TIME", &time)}) {
      const Scene scene("tiny", {"robot.attitude=LEVEL", std::string("explorer.minimize=") + minimize});
      const LockstepOptions options =
          scene.Options("closest", seed, PoseSource::kTruth, MotionModel::kDynamic);
      mapper::OccupancyMap map(options.mapper);
      *sum += RunLockstep(scene.world(), scene.Start(seed), options, map).duration;
    }
  }
  EXPECT_LT(time, 0.9 * path);
}

TEST(DynamicMotionWithOdometry, IsRefused) {
  const Scene scene("tiny_odometry");
  const LockstepOptions options = scene.Options("closest", 1, PoseSource::kOdometry, MotionModel::kDynamic);
  mapper::OccupancyMap map(options.mapper);
  EXPECT_THROW(RunLockstep(scene.world(), scene.Start(1), options, map), std::invalid_argument);
}

/// The tiny room with a small camera, so that rendering is fast.
class OwnPoseTest : public testing::Test {
 protected:
  LockstepResult Run(double seconds, int lost_inliers) const {
    LockstepOptions options = scene_.Options("closest", 1, PoseSource::kOdometry);
    options.explorer.time_budget = FromSeconds(seconds);
    options.own_pose->estimator.lost_inliers = lost_inliers;
    int& recognized = options.own_pose->estimator.finder.least_inliers;
    recognized = std::max(recognized, lost_inliers);
    mapper::OccupancyMap map(options.mapper);
    return RunLockstep(scene_.world(), scene_.Start(0), options, map);
  }

  Scene scene_{"tiny",
               {"robot.max_turn_rate_dps=45", "stereo_camera.width_px=200", "stereo_camera.height_px=150",
                "stereo_camera.rate_hz=10", "stereo_camera.noise_sigma=1"}};
  const int usual_ = visual_odometry::VisualOdometry::Options{}.lost_inliers;
};

TEST_F(OwnPoseTest, ARobotThatFindsItsPoseFromImagesDriftsLittleAndEachTimeTheSame) {
  const LockstepResult first = Run(10.0, usual_);
  ASSERT_TRUE(first.own_pose);
  EXPECT_NEAR(static_cast<double>(first.own_pose->frames), 10.0 * first.duration, 2.0);
  EXPECT_EQ(first.own_pose->lost, 0U);
  EXPECT_GT(first.distance, 0.0);
  EXPECT_GT(first.own_pose->greatest_drift, 0.0);
  EXPECT_LT(first.own_pose->greatest_drift, 0.02);
  EXPECT_EQ(first.collisions, 0);
  const LockstepResult second = Run(10.0, usual_);
  EXPECT_EQ(second.own_pose, first.own_pose);
  EXPECT_EQ(second.distance, first.distance);
  EXPECT_EQ(second.scans, first.scans);
}

TEST_F(OwnPoseTest, OneThatGetsLostGoesBackAndExploresOnWithoutACollision) {
  LockstepResult result;
  // This many points cannot be seen everywhere; where depends on the path.
  for (int inliers = 130; inliers <= 170; inliers += 20) {
    result = Run(30.0, inliers);
    ASSERT_TRUE(result.own_pose);
    if (result.own_pose->losses > 0) break;
  }
  std::cout << result.own_pose->losses << " losses, " << result.own_pose->lost << " of "
            << result.own_pose->frames << " frames lost, " << result.distance << " m, "
            << result.own_pose->greatest_drift << " m off at worst, " << ToText(result.end) << '\n';
  EXPECT_GT(result.own_pose->losses, 0U) << "it was too easy to say anything";
  EXPECT_LT(result.own_pose->lost, result.own_pose->frames / 2);
  EXPECT_NE(result.end.kind, RunEnd::Kind::kLost);
  EXPECT_LT(result.own_pose->greatest_drift, 0.1);
  EXPECT_EQ(result.collisions, 0);
}

TEST(LockstepBody, ACylindersContactsAreCountedWhereASphereHasNone) {
  const Scene scene("tiny");
  const RigidTransform start = scene.Start(0);
  LockstepOptions options = scene.Options("closest", 1);
  const auto run = [&] {
    mapper::OccupancyMap map(options.mapper);
    return RunLockstep(scene.world(), start, options, map);
  };
  const LockstepResult sphere = run();
  options.robot.height = 1.5;  // the room is 1.6 m high, and the explorer still plans for a sphere
  const LockstepResult cylinder = run();
  EXPECT_EQ(cylinder.distance, sphere.distance);
  EXPECT_EQ(sphere.collisions, 0);
  EXPECT_LT(cylinder.least_clearance, sphere.least_clearance);
  double least = 1e9;
  for (const LockstepResult::Sample& sample : cylinder.samples) {
    least = std::min(least, scene.world().ClearanceOf(options.robot, sample.p_W, 1.0));
  }
  EXPECT_LE(cylinder.least_clearance, least);
  EXPECT_NEAR(cylinder.least_clearance, least, options.robot.max_speed / options.sensor.rate)
      << "of its scans";
  EXPECT_EQ(cylinder.collisions > 0, cylinder.least_clearance < 0.0);
}

TEST(DrivingScene, HasOneTruthForAllItsStartsWhichIsTheLayerOfItsBody) {
  const Scene scene("flat_ground");
  const Eigen::Vector3d start = scene.Start(0).translation();
  const auto truth = scene.Truth(start);
  EXPECT_EQ(truth->voxels().box().min.z, 1) << "0.15 m to 0.55 m";
  EXPECT_EQ(truth->voxels().box().max.z, 6);
  EXPECT_GT(truth->observable_count(), truth->voxels().size() / 2);
  for (int seed = 1; seed <= 5; ++seed) {
    const RigidTransform other = scene.Start(seed);
    EXPECT_EQ(other.translation().z(), start.z());
    EXPECT_EQ(scene.Truth(other.translation()), truth);
  }
}

TEST(DrivingScene, CountsWhatIsSeenOfThePlacesWhereItsBodyWas) {
  const Scene scene("flat_ground");
  const RigidTransform start = scene.Start(1);
  const auto truth = scene.Truth(start.translation());
  const LockstepOptions options = scene.Options("closest", 1);
  mapper::OccupancyMap map(options.mapper);
  const LockstepResult result = RunLockstep(scene.world(), start, options, map, {}, truth.get());
  const double observed = static_cast<double>(result.samples.back().observed);
  EXPECT_DOUBLE_EQ(observed / static_cast<double>(truth->observable_count()),
                   Judge(result, map.grid(), *truth).coverage);
}

TEST(DrivingScene, IsExploredFromAMast) {
  // With the camera half a meter above its body's center, it sees the lower end of its band 1.2 m ahead.
  const Outcome outcome = Scene("flat_ground", {"robot.camera_position_m.z=0.5"}).Run("closest", 1);
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GE(outcome.coverage, 0.97);
}

}  // namespace
}  // namespace thalweg::evaluator
