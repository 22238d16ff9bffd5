#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/controller/core/path_follower.h"
#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::Differences;
using test::kTick;
using test::Ride;

PathFollower::Options GoingBack(OnCutOff action) {
  PathFollower::Options options;
  options.cut_off = {.action = action, .after = 4.0, .step = 1.0};
  return options;
}

bool GoesBack(const Motion& motion) {
  return motion.reason == StopReason::kGoingBack;
}
bool WaitsWhereItBegan(const Motion& motion) {
  return motion.reason == StopReason::kWentBack && motion.back == BackPlace::kBeginning;
}

TEST(PathFollower, CutOffFromItsExplorerItGoesBackOnThePathItCameWithinItsLimits) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(2, 0, 0, 1.0), At(2, 3, 0, 2.0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().y() > 1.0; });
  ride.path_silent = true;
  const double heard = ride.last_heard();
  Differences differences;
  const Motion going = ride.Until(GoesBack);
  EXPECT_NEAR(ride.now() - heard, 4.0, 2.0 * kTick);
  EXPECT_EQ(going.state, MotionState::kStopped);
  const double began = ride.now();
  ride.Until([&](const Motion& motion) {
    const Eigen::Vector3d p_W = ride.robot().translation();
    EXPECT_LE(std::min(std::abs(p_W.y()), std::abs(p_W.x() - 2.0)), 0.02) << p_W.transpose();
    differences.Add(motion.command->T_WB);
    return WaitsWhereItBegan(motion);
  });
  const PathFollower::Options limits;
  EXPECT_LE(differences.speed, limits.robot.max_speed + 1e-9);
  EXPECT_LE(differences.turn_rate, limits.robot.max_turn_rate + 1e-6);
  EXPECT_LE(differences.speed_step, limits.robot.max_acceleration * kTick + limits.corner_step + 1e-6);
  EXPECT_LT(ride.robot().translation().norm(), 0.03);
  EXPECT_LT(ride.now() - began, 3.3 / limits.robot.max_speed + 5.0) << "it does not dawdle";
  // Without a word it stays there.
  const RigidTransform there = ride.robot();
  const double waits = ride.now();
  const Motion waiting = ride.Until([&](const Motion&) { return ride.now() - waits > 20.0; });
  EXPECT_TRUE(WaitsWhereItBegan(waiting)) << static_cast<int>(waiting.reason);
  EXPECT_TRUE(ride.robot().isApprox(there, 1e-9));
}

TEST(PathFollower, RetreatsInStepsAndWaitsBetweenThem) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kRetreat));
  ride.Follow({At(0, 0), At(9, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 2.5; });
  ride.path_silent = true;
  const double heard_at = ride.robot().translation().x();
  std::vector<double> waits;
  ride.Until([&](const Motion& motion) {
    const bool waiting = motion.reason == StopReason::kWentBack;
    const double x = ride.robot().translation().x();
    if (waiting && (waits.empty() || std::abs(waits.back() - x) > 0.1)) waits.push_back(x);
    return WaitsWhereItBegan(motion);
  });
  ASSERT_EQ(waits.size(), 4U);
  EXPECT_NEAR(waits[0], heard_at, 0.06);
  EXPECT_NEAR(waits[1], waits[0] - 1.0, 0.04);
  EXPECT_NEAR(waits[2], waits[1] - 1.0, 0.04);
  EXPECT_NEAR(waits[3], 0.0, 0.03);
}

TEST(PathFollower, APathThatIsHeardEndsThePathBackAtOnce) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 2.0; });
  ride.path_silent = true;
  ride.Until([&](const Motion& motion) { return GoesBack(motion) && ride.robot().translation().x() < 1.5; });
  ride.path_silent = false;
  double least = 5.0;
  Differences differences;
  const Motion end = ride.Until([&](const Motion& motion) {
    least = std::min(least, ride.robot().translation().x());
    differences.Add(motion.command->T_WB);
    EXPECT_FALSE(GoesBack(motion)) << "it has heard a path";
    return motion.state == MotionState::kDone;
  });
  EXPECT_GT(least, 1.5 - 0.2) << "it brakes from full speed in 0.125 m";
  const PathFollower::Options limits;
  EXPECT_LE(differences.speed_step, limits.robot.max_acceleration * kTick + limits.corner_step + 1e-6);
  EXPECT_NEAR(ride.robot().translation().x(), 5.0, 0.03);
  EXPECT_EQ(end.reason, StopReason::kNone);
}

TEST(PathFollower, ARobotAtTheEndOfItsPathGoesBackAsWell) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(1, 0)});
  ride.UntilDone();
  ride.path_silent = true;
  ride.Until(WaitsWhereItBegan);
  EXPECT_LT(ride.robot().translation().norm(), 0.03);
}

TEST(PathFollower, OnItsPathBackItStopsWhenItsPoseIsSilentOrLost) {
  for (const bool lost : {false, true}) {
    Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
    ride.Follow({At(0, 0), At(5, 0)});
    ride.Until([&](const Motion&) { return ride.robot().translation().x() > 2.0; });
    ride.path_silent = true;
    ride.Until(
        [&](const Motion& motion) { return GoesBack(motion) && ride.robot().translation().x() < 1.5; });
    ride.pose_silent = true;
    const double x = ride.robot().translation().x();
    for (int tick = 0; tick < 200; ++tick) {
      if (lost) ride.controller().SetLost(true, ride.time());
      ride.Tick();
    }
    EXPECT_NEAR(ride.robot().translation().x(), x, lost ? 0.1 : 0.3);
    EXPECT_EQ(ride.Tick().reason, lost ? StopReason::kLost : StopReason::kPoseSilent);
    ride.pose_silent = false;
    ride.controller().SetLost(false, ride.time());
    ride.Until(WaitsWhereItBegan);
    EXPECT_LT(ride.robot().translation().norm(), 0.03);
  }
}

TEST(PathFollower, ARobotThatIsToStayDoesNotGoBack) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.controller().SetStays(true);
  ride.path_silent = true;
  const double silent = ride.now();
  const Motion motion = ride.Until([&](const Motion&) { return ride.now() - silent > 30.0; });
  EXPECT_EQ(motion.reason, StopReason::kPathSilent);
  EXPECT_GT(ride.robot().translation().x(), 1.0);
}

}  // namespace
}  // namespace thalweg::controller
