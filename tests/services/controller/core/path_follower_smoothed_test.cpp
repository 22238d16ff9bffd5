#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "services/controller/core/path_follower.h"
#include "tests/services/controller/support/ride.h"

/// The path follower with limited jerk.
namespace thalweg::controller {
namespace {

using test::At;
using test::Differences;
using test::kTick;
using test::RandomPath;
using test::Ride;

RobotModel FastRobot() {
  RobotModel robot;
  robot.max_speed = 2.0;
  robot.max_acceleration = 3.0;
  robot.max_jerk = 30.0;
  return robot;
}

PathFollower::Options FastAndSmooth() {
  PathFollower::Options options{.robot = FastRobot(), .retreat = {}};
  options.silence = 1.0;
  return options;
}

/// A circle as a fine polyline, as the explorer's curves are.
std::vector<RigidTransform> Circle(double radius) {
  std::vector<RigidTransform> path;
  for (int n = 0; n <= 96; ++n) {
    const double angle = 2.0 * M_PI * n / 96.0;
    path.push_back(At(radius * std::sin(angle), radius * (1.0 - std::cos(angle))));
  }
  return path;
}

TEST(PathFollowerSmoothed, KeepsSpeedAndAccelerationAndTurnLimits) {
  std::mt19937 random(4);
  for (int round = 0; round < 20; ++round) {
    Ride ride(At(0, 0), FastAndSmooth());
    ride.Follow(RandomPath(random, At(0, 0), 12, round % 2 == 0 ? 2.0 : 0.3));
    const PathFollower::Options& limits = ride.options();
    Differences differences;
    ride.Until([&](const Motion& motion) {
      differences.Add(motion.command->T_WB);
      return motion.state == MotionState::kDone;
    });
    EXPECT_LE(differences.speed, limits.robot.max_speed + 1e-9);
    // A corner's step of the velocity is spread over the window.
    const double corner = limits.corner_step * kTick / limits.robot.smoothing();
    EXPECT_LE(differences.speed_step, limits.robot.max_acceleration * kTick + corner + 1e-9);
    EXPECT_LE(differences.turn_step, limits.robot.max_turn_acceleration * kTick + 1e-6);
  }
}

TEST(PathFollowerSmoothed, KeepsTheJerkOnAStraightLineAndStaysOnIt) {
  Ride ride(At(0, 0), FastAndSmooth());
  ride.Follow({At(0, 0), At(6, 0)});
  std::optional<double> x0, v0, a0;
  double most = 0.0;
  ride.Until([&](const Motion& motion) {
    const Eigen::Vector3d p = motion.command->T_WB.translation();
    EXPECT_EQ(p.y(), 0.0);
    const std::optional<double> v = x0 ? std::optional((p.x() - *x0) / kTick) : std::nullopt;
    const std::optional<double> a = v && v0 ? std::optional((*v - *v0) / kTick) : std::nullopt;
    if (a && a0) most = std::max(most, std::abs(*a - *a0) / kTick);
    x0 = p.x();
    v0 = v;
    a0 = a;
    return motion.state == MotionState::kDone;
  });
  EXPECT_LE(most, FastRobot().max_jerk);
  EXPECT_GE(most, 0.45 * FastRobot().max_jerk) << "a / smoothing() while the acceleration is reached";
}

TEST(PathFollowerSmoothed, CutsACurveByNoMoreThanIsAllowed) {
  for (const double radius : {0.4, 1.0, 3.0}) {
    Ride ride(At(0, 0), FastAndSmooth());
    const std::vector<RigidTransform> path = Circle(radius);
    const Track track(path, {});
    ride.Follow(path);
    double farthest = 0.0;
    ride.Until([&](const Motion& motion) {
      const Eigen::Vector3d p = motion.command->T_WB.translation();
      farthest = std::max(farthest, track.NearestTo(p, 0.0, track.length()).distance);
      return motion.state == MotionState::kDone;
    });
    EXPECT_LE(farthest, 0.005) << radius;
    EXPECT_LT((ride.robot().translation() - path.back().translation()).norm(), 1e-6);
  }
}

TEST(PathFollowerSmoothed, TakesALineAWindowLater) {
  Ride ride(At(0, 0), FastAndSmooth());
  ride.Follow({At(0, 0), At(6, 0)});
  const double start = ride.now();
  ride.UntilDone();
  EXPECT_NEAR(ride.now() - start, 6.0 / 2.0 + 2.0 / 3.0 + FastRobot().smoothing(), 3.0 * kTick);
}

TEST(PathFollowerSmoothed, StandsInTimeWhenThePathFallsSilent) {
  Ride ride(At(0, 0), FastAndSmooth());
  ride.Follow({At(0, 0), At(30, 0)});
  ride.Until([](const Motion& motion) { return motion.speed > 1.999; });
  ride.path_silent = true;
  ride.Until([](const Motion& motion) { return motion.speed == 0.0; });
  EXPECT_LE(ride.now() - ride.last_heard(), FastAndSmooth().silence + kTick);
}

TEST(PathFollowerSmoothed, WaitsForARobotThatIsStuckAndGoesOn) {
  Ride ride(At(0, 0), FastAndSmooth());
  ride.Follow({At(0, 0), At(30, 0)});
  ride.Until([](const Motion& motion) { return motion.speed > 1.999; });
  ride.stuck = true;
  const Eigen::Vector3d held = ride.robot().translation();
  const Motion motion = ride.Until([](const Motion& m) { return m.reason == StopReason::kBlocked; });
  // Its greatest lead: braking, the delay, and the lag of the mean.
  EXPECT_LE((motion.command->T_WB.translation() - held).norm(), 2.0 * (1.0 / 3.0 + 0.2 + 0.15));
  ride.stuck = false;
  ride.UntilDone();
}

TEST(PathFollowerSmoothed, JoinsAnotherPathWithoutAJump) {
  for (const double speed : {2.0, 3.0}) {
    std::mt19937 random(8);
    RobotModel robot = FastRobot();
    robot.max_speed = speed;
    PathFollower::Options options{.robot = robot, .retreat = {}};
    options.silence = 1.2;
    Ride ride(At(0, 0), options);
    const PathFollower::Options& limits = ride.options();
    Differences differences;
    const auto ticks = [&](int count) {
      Motion motion;
      for (int n = 0; n < count; ++n) {
        motion = ride.Tick();
        if (motion.command) differences.Add(motion.command->T_WB);
      }
      return motion;
    };
    for (int round = 0; round < 30; ++round) {
      ride.Follow(RandomPath(random, ride.robot(), 6, 1.0));
      ticks(50);
    }
    // One that goes on straight, which is joined at full speed.
    const Eigen::Vector3d from = ride.robot().translation();
    const auto ahead = [&](double x) { return At(from.x() + x, from.y(), from.z()); };
    ride.Follow({ahead(0), ahead(60)});
    EXPECT_NEAR(ticks(200).speed, speed, 1e-6);
    const double x = ride.robot().translation().x() - from.x();
    ride.Follow({ahead(x), ahead(70)});
    EXPECT_NEAR(ticks(20).speed, speed, 1e-6) << "it did not stop for that";
    const double corner = limits.corner_step * kTick / limits.robot.smoothing();
    EXPECT_LE(differences.speed_step,
              limits.emergency_factor * limits.robot.max_acceleration * kTick + 2.0 * corner);
  }
}

TEST(PathFollowerSmoothed, ARobotThatIsPushedAsideAtFullSpeedIsOffItsPath) {
  Ride ride(At(0, 0), FastAndSmooth());
  ride.Follow({At(0, 0), At(30, 0)});
  ride.Until([](const Motion& motion) { return motion.speed > 1.999; });
  ride.robot().translation().y() += 0.35;
  ride.stuck = true;
  const Motion motion = ride.Tick();
  EXPECT_EQ(motion.reason, StopReason::kOffPath);
}

}  // namespace
}  // namespace thalweg::controller
