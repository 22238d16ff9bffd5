#include <gtest/gtest.h>

#include <random>

#include "services/controller/core/path_follower.h"
#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::Differences;
using test::kTick;
using test::RandomPath;
using test::Ride;

TEST(PathFollower, NewPathOnTheWayIsContinuousInPositionAndVelocity) {
  std::mt19937 random(5);
  for (int round = 0; round < 30; ++round) {
    Ride ride(At(0, 0));
    const PathFollower::Options& limits = ride.options();
    Differences differences;
    ride.Follow(RandomPath(random, At(0, 0), 6, 1.0));
    for (int change = 0; change < 5; ++change) {
      const double start = ride.now();
      ride.Until([&](const Motion& motion) {
        differences.Add(motion.command->T_WB);
        return ride.now() - start > 0.9;
      });
      ride.Follow(RandomPath(random, ride.robot(), 6, 1.0));
    }
    const Motion motion = ride.Until([&](const Motion& m) {
      differences.Add(m.command->T_WB);
      return m.state == MotionState::kDone;
    });
    EXPECT_LE(differences.speed, limits.robot.max_speed + 1e-9);
    EXPECT_LE(differences.turn_rate, limits.robot.max_turn_rate + 1e-9);
    EXPECT_LE(differences.speed_step, limits.robot.max_acceleration * kTick + limits.corner_step + 1e-9);
    EXPECT_LE(differences.turn_step, limits.robot.max_turn_acceleration * kTick + 1e-6);
    EXPECT_EQ(motion.reason, StopReason::kNone);
  }
}

TEST(PathFollower, NewPathStraightOnDoesNotSlowDown) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(2, 0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.Follow({At(0.95, 0), At(4, 0)});
  const double start = ride.now();
  ride.Until([&](const Motion& motion) {
    EXPECT_NEAR(motion.speed, 0.5, 1e-6);
    return ride.now() - start > 2.0;
  });
}

TEST(PathFollower, NewPathThatGoesOnInACurveIsJoinedThereAtSpeed) {
  constexpr double kRadius = 0.2;  // [m] Passed as fast as the lateral acceleration allows.
  const auto circle = [](int from) {
    std::vector<RigidTransform> path;
    for (int n = from; n <= 300; ++n)
      path.push_back(At(kRadius * std::sin(0.05 * n), kRadius * (1.0 - std::cos(0.05 * n))));
    return path;
  };
  Ride ride(At(0, 0));
  ride.Follow(circle(0));
  const double speed = std::sqrt(RobotModel{}.max_acceleration * kRadius);
  for (int vertex = 40; vertex < 140; vertex += 7) {
    ride.Until([&](const Motion& motion) { return motion.distance_left < (300 - vertex) * 0.05 * kRadius; });
    ride.Follow(circle(vertex - 3));
    for (int tick = 0; tick < 3; ++tick) EXPECT_GT(ride.Tick().speed, 0.99 * speed) << vertex;
  }
}

}  // namespace
}  // namespace thalweg::controller
