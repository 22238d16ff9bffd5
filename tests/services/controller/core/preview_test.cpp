#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "services/controller/core/path_follower.h"
#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::kTick;
using test::RandomPath;
using test::Ride;

PathFollower::Options Smoothed() {
  PathFollower::Options options;
  options.robot.max_jerk = 2.0 * options.robot.max_acceleration / 0.2;
  options.silence = 1.0;
  return options;
}

TEST(Preview, IsEmptyBeforeThereIsACommand) {
  EXPECT_TRUE(PathFollower({}).Preview(0.1, 5.0).empty());
  Ride ride(At(0, 0));
  ride.Tick();
  EXPECT_TRUE(ride.controller().Preview(0.1, 5.0).empty());
}

TEST(Preview, IsWhatARobotThatObeysThenDoes) {
  std::mt19937 random(11);
  for (const PathFollower::Options& options : {PathFollower::Options{}, Smoothed()}) {
    for (int round = 0; round < 10; ++round) {
      Ride ride(At(0, 0), options);
      ride.Follow(RandomPath(random, At(0, 0), 3, 0.3));
      for (int n = 0; n < 40; ++n) ride.Tick();
      const std::vector<TrajectoryPoint> points = ride.controller().Preview(kTick, 60.0);
      ASSERT_GT(points.size(), 10U);
      for (std::size_t n = 1; n < points.size(); ++n) {
        const RigidTransform T_WB = ride.Tick().command->T_WB;
        EXPECT_LT((T_WB.translation() - points[n].T_WB.translation()).norm(), 1e-6) << points[n].time;
        EXPECT_LT(AngleBetween(T_WB, points[n].T_WB), 1e-6) << points[n].time;
      }
      EXPECT_EQ(ride.Tick().state, MotionState::kDone);
    }
  }
}

TEST(Preview, VelocitiesAndAccelerationsAreTheDerivatives) {
  std::mt19937 random(12);
  for (const PathFollower::Options& options : {PathFollower::Options{}, Smoothed()}) {
    Ride ride(At(0, 0), options);
    ride.Follow(RandomPath(random, At(0, 0), 5, 0.5));
    ride.Tick();
    const std::vector<TrajectoryPoint> points = ride.controller().Preview(kTick, 60.0);
    ASSERT_GT(points.size(), 100U);
    for (std::size_t n = 0; n + 1 < points.size(); ++n) {
      const TrajectoryPoint& a = points[n];
      const TrajectoryPoint& b = points[n + 1];
      EXPECT_NEAR(b.time - a.time, kTick, 1e-9);
      const Eigen::Vector3d moved = b.T_WB.translation() - a.T_WB.translation();
      const double most = options.robot.max_acceleration * kTick + options.corner_step;
      EXPECT_LT((moved / kTick - 0.5 * (a.v_W + b.v_W)).norm(), most);
      EXPECT_LT((a.a_W * kTick - (b.v_W - a.v_W)).norm(), 1e-9);
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(b.T_WB.linear() * a.T_WB.linear().transpose()));
      EXPECT_LT((turn.angle() * turn.axis() / kTick - b.w_W).norm(), 1e-3);
    }
  }
}

TEST(Preview, OfALongPathBrakesGentlyAtTheHorizon) {
  for (const PathFollower::Options& options : {PathFollower::Options{}, Smoothed()}) {
    Ride ride(At(0, 0), options);
    ride.Follow({At(0, 0), At(30, 0)});
    for (int n = 0; n < 60; ++n) ride.Tick();
    const std::vector<TrajectoryPoint> points = ride.controller().Preview(0.1, 2.0);
    ASSERT_GT(points.size(), 20U);
    EXPECT_NEAR(points[20].v_W.x(), options.robot.max_speed, 1e-9);
    EXPECT_NEAR(points[20].time, 2.0, 1e-9);
    const double stop =
        2.0 + options.robot.max_speed / options.robot.max_acceleration + options.robot.smoothing();
    EXPECT_NEAR(points.back().time, stop, 0.1);
    EXPECT_EQ(points.back().v_W, Eigen::Vector3d::Zero());
    EXPECT_EQ(points.back().a_W, Eigen::Vector3d::Zero());
    for (const TrajectoryPoint& point : points)
      EXPECT_LE(point.a_W.norm(), options.robot.max_acceleration + 1e-6);
    // The follower itself has not noticed.
    const Motion motion = ride.Tick();
    EXPECT_EQ(motion.state, MotionState::kFollowing);
    EXPECT_NEAR(motion.speed, options.robot.max_speed, 1e-9);
  }
}

TEST(Preview, OfARobotThatStandsIsOnePoint) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(0.3, 0)});
  ride.UntilDone();
  const std::vector<TrajectoryPoint> points = ride.controller().Preview(0.1, 5.0);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points.front().T_WB.translation().x(), 0.3, 1e-6);
  EXPECT_EQ(points.front().v_W, Eigen::Vector3d::Zero());
}

TEST(Preview, OfARobotThatIsStoppedEndsWhereItBrakes) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(3, 0)});
  for (int n = 0; n < 100; ++n) ride.Tick();
  ride.Follow({});
  ride.Tick();
  const std::vector<TrajectoryPoint> points = ride.controller().Preview(kTick, 5.0);
  ride.Until([](const Motion& motion) { return motion.speed == 0.0; });
  EXPECT_NEAR((points.back().T_WB.translation() - ride.robot().translation()).norm(), 0.0, 1e-9);
}

TEST(Preview, OfARobotWhosePoseIsSilentIsItsStop) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(5, 0)});
  for (int n = 0; n < 100; ++n) ride.Tick();
  ride.pose_silent = true;
  ride.Until([](const Motion& motion) { return motion.reason == StopReason::kPoseSilent; });
  const std::vector<TrajectoryPoint> points = ride.controller().Preview(0.1, 5.0);
  EXPECT_LT(points.back().time, 0.5);
  EXPECT_EQ(points.back().v_W, Eigen::Vector3d::Zero());
  const double stopped = points.back().T_WB.translation().x();
  ride.Until([](const Motion& motion) { return motion.speed == 0.0; });
  const std::vector<TrajectoryPoint> later = ride.controller().Preview(0.1, 5.0);
  ASSERT_EQ(later.size(), 1U) << "it does not go on";
  EXPECT_NEAR(later.front().T_WB.translation().x(), stopped, 0.03);
}

TEST(Preview, AReportOfBeingLostThatHasExpiredCountsNoMore) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(3, 0)});
  for (int n = 0; n < 60; ++n) ride.Tick();
  ride.controller().SetLost(true, ride.time());
  for (int n = 0; n < 40; ++n) ride.Tick();
  const double x = ride.robot().translation().x();
  EXPECT_GT(ride.controller().Preview(0.1, 5.0).back().T_WB.translation().x(), x + 1.0);
}

TEST(Preview, EndsBeforeWhatHasNotBeenCheckedAndBeforeWhatIsSolid) {
  PathFollower::Options options;
  options.robot.max_speed = 5.0;
  options.robot.max_acceleration = 10.0;
  options.silence = 1.0;
  options.checked_body = PathCheck::Body{.radius = 0.6};
  for (const double wall : {1e6, 6.0}) {
    OccupancyGrid map(0.05);
    for (int y = -20; y < 20 && wall < 1e3; ++y) {
      for (int z = -20; z < 20; ++z) map.Set({static_cast<int>(wall / 0.05), y, z}, 2.0F);
    }
    Ride ride(At(0, 0), options);
    ride.controller().SetMap(map, ride.time());
    ride.Follow({At(0, 0), At(60, 0)});
    ride.Tick();
    ride.Tick();
    const std::vector<TrajectoryPoint> points = ride.controller().Preview(0.1, 30.0);
    ASSERT_FALSE(points.empty());
    EXPECT_LT(points.back().T_WB.translation().x(), std::min(wall - 0.6, 59.0));
    EXPECT_EQ(points.back().v_W, Eigen::Vector3d::Zero());
  }
}

TEST(Preview, OfALostRobotIsItsRetreat) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(3, 0)});
  for (int n = 0; n < 100; ++n) ride.Tick();
  ride.controller().SetLost(true, ride.time());
  ride.Tick();
  const std::vector<TrajectoryPoint> points = ride.controller().Preview(0.1, 20.0);
  ASSERT_GT(points.size(), 5U);
  EXPECT_LT(points.back().T_WB.translation().x(), ride.robot().translation().x() - 0.2);
  EXPECT_LT(points[points.size() / 2].v_W.x(), 0.0);
}

}  // namespace
}  // namespace thalweg::controller
