#include <gtest/gtest.h>

#include <algorithm>

#include "services/controller/core/path_follower.h"
#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::Differences;
using test::kTick;
using test::Ride;

TEST(PathFollower, SilentPathStandsStillWithinHalfASecond) {
  for (const double moment : {0.3, 1.0, 1.7, 3.33}) {
    Ride ride(At(0, 0));
    ride.Follow({At(0, 0), At(10, 0, 0, 3.0)});
    const double start = ride.now();
    ride.Until([&](const Motion&) { return ride.now() - start > moment; });
    ride.path_silent = true;
    ride.Until([&](const Motion&) { return ride.now() - ride.last_heard() >= 0.5 - 1e-9; });
    const RigidTransform then = ride.robot();
    const Motion motion = ride.Until([&](const Motion&) { return ride.now() - ride.last_heard() > 3.0; });
    EXPECT_EQ(motion.state, MotionState::kStopped);
    EXPECT_EQ(motion.reason, StopReason::kPathSilent);
    EXPECT_TRUE(motion.command->v_WB_B.isZero());
    EXPECT_TRUE(motion.command->w_WB_B.isZero());
    EXPECT_TRUE(then.isApprox(motion.command->T_WB, 1e-12));
  }
}

TEST(PathFollower, SilentPoseStandsStillWithinHalfASecond) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(10, 0)});
  const double start = ride.now();
  ride.Until([&](const Motion&) { return ride.now() - start > 2.0; });
  ride.pose_silent = true;
  const double silent = ride.now();
  ride.Until([&](const Motion&) { return ride.now() - silent >= 0.5 - 1e-9; });
  const RigidTransform then = ride.robot();
  const Motion motion = ride.Until([&](const Motion&) { return ride.now() - silent > 3.0; });
  EXPECT_EQ(motion.reason, StopReason::kPoseSilent);
  EXPECT_TRUE(then.isApprox(motion.command->T_WB, 1e-12));
}

TEST(PathFollower, ASilentPoseIsNoticedAsSoonAlthoughItsClockIsAhead) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(10, 0)});
  ride.pose_silent = true;
  const double start = ride.now();
  ride.Until([&](const Motion&) {
    ride.controller().SetPose(ride.robot(), ride.time() + std::chrono::seconds(10));
    return ride.now() - start > 2.0;
  });
  EXPECT_GT(ride.robot().translation().x(), 0.5) << "it moves, or there is nothing to stop";
  const double silent = ride.now();
  ride.Until([&](const Motion&) { return ride.now() - silent >= 0.5 - 1e-9; });
  const RigidTransform then = ride.robot();
  const Motion motion = ride.Until([&](const Motion&) { return ride.now() - silent > 3.0; });
  EXPECT_EQ(motion.reason, StopReason::kPoseSilent);
  EXPECT_TRUE(then.isApprox(motion.command->T_WB, 1e-12));
}

TEST(PathFollower, ARobotThatIsLostStopsAndGoesBackWithoutAPose) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.pose_silent = true;
  double farthest = 0.0;
  double last = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    ride.controller().SetLost(true, ride.time());
    const Motion motion = ride.Tick();
    EXPECT_EQ(motion.state, MotionState::kStopped);
    last = ride.robot().translation().x();
    farthest = std::max(farthest, last);
  }
  EXPECT_LT(farthest, 1.15) << "it braked at once";
  EXPECT_NEAR(farthest - last, PathFollower::Options{}.retreat.reach, 0.02);
  // Once found again, the robot continues from where it is.
  ride.controller().SetLost(false, ride.time());
  ride.pose_silent = false;
  const Motion end = ride.UntilDone();
  EXPECT_EQ(end.state, MotionState::kDone);
  EXPECT_NEAR(ride.robot().translation().x(), 5.0, 0.03);
}

TEST(PathFollower, ALostRobotStandsWhenItsExplorerIsSilent) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.pose_silent = true;
  ride.path_silent = true;
  for (int tick = 0; tick < 50; ++tick) {
    ride.controller().SetLost(true, ride.time());
    ride.Tick();
  }
  const double stands = ride.robot().translation().x();
  for (int tick = 0; tick < 50; ++tick) {
    ride.controller().SetLost(true, ride.time());
    ride.Tick();
  }
  EXPECT_EQ(ride.robot().translation().x(), stands);
}

TEST(PathFollower, GoesOnByItselfWhenThePathIsHeardAgain) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(3, 0)});
  Differences differences;
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.path_silent = true;
  ride.Until(
      [&](const Motion& motion) { return motion.state == MotionState::kStopped && motion.speed == 0; });
  ride.path_silent = false;
  const Motion motion = ride.Until([&](const Motion& m) {
    differences.Add(m.command->T_WB);
    return m.state == MotionState::kDone;
  });
  EXPECT_NEAR(motion.distance_done, 3.0, 1e-9);
  EXPECT_LE(differences.speed_step, kTick + 1e-9);
}

TEST(PathFollower, ClockThatStartsAgainDoesNotStopItForEver) {
  PathFollower follower({});
  Time now = Time{} + FromSeconds(1000.0);
  follower.SetPath(now, {At(0, 0), At(1, 0)}, now);
  follower.SetPose(At(0, 0), now);
  follower.Step(now);
  RigidTransform robot = At(0, 0);
  Motion motion;
  for (double t = 0.0; t < 6.0; t += kTick) {
    now = Time{} + FromSeconds(t);
    follower.SetPath(Time{} + FromSeconds(1000.0), {At(0, 0), At(1, 0)}, now);
    follower.SetPose(robot, now);
    motion = follower.Step(now);
    robot = motion.command->T_WB;
    EXPECT_TRUE(robot.matrix().allFinite());
  }
  EXPECT_EQ(motion.state, MotionState::kDone);
}

}  // namespace
}  // namespace thalweg::controller
