#include "services/controller/core/pose_gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/services/controller/support/poses.h"

namespace thalweg::controller {
namespace {

using test::OnAxis;

Time After(double seconds) {
  return Time{} + FromSeconds(seconds);
}

TEST(PoseGate, LetsPassWhatTheRobotCanReach) {
  PoseGate gate({.max_speed = 0.5, .max_turn_rate = 1.6});
  for (int k = 0; k < 500; ++k) {
    const double jitter = k % 2 == 0 ? 0.04 : -0.04;
    EXPECT_FALSE(gate.Refuse(OnAxis(0.5 * 0.02 * k + jitter, 1.6 * 0.02 * k), After(0.02 * k)));
  }
  EXPECT_FALSE(gate.Refuse(OnAxis(5.0 + 1.5, 16.0), After(10.0 + 1.0))) << "a second later";
}

TEST(PoseGate, RefusesAJumpAndSaysHowFar) {
  PoseGate gate({.max_speed = 0.5});
  EXPECT_FALSE(gate.Refuse(OnAxis(0.0), After(1.0)));
  const auto jump = gate.Refuse(OnAxis(2.0), After(1.02));
  ASSERT_TRUE(jump);
  EXPECT_NEAR(jump->distance, 2.0, 1e-9);
  EXPECT_NEAR(jump->turn, 0.0, 1e-9);
  EXPECT_NEAR(jump->time, 0.02, 1e-9);
  EXPECT_FALSE(gate.Refuse(OnAxis(0.01), After(1.04)));
  EXPECT_TRUE(gate.Refuse(OnAxis(0.0, 2.0), After(1.06))) << "a turn";
}

TEST(PoseGate, BelievesPosesThatStayElsewhereForASecondButNotThoseThatJumpAbout) {
  PoseGate gate({.max_speed = 0.1, .factor = 1.0});
  EXPECT_FALSE(gate.Refuse(OnAxis(0.0), After(0.0)));
  double believed = -1.0;
  for (int k = 1; k < 100 && believed < 0.0; ++k) {
    if (!gate.Refuse(OnAxis(5.0 + 0.001 * k), After(0.02 * k))) believed = 0.02 * k;
  }
  EXPECT_NEAR(believed, 1.02, 1e-9);
  for (int k = 1; k < 100; ++k) {
    EXPECT_TRUE(gate.Refuse(OnAxis(20.0 + k), After(believed + 0.02 * k))) << k;
  }
}

TEST(PoseGate, AStampFarAheadExcusesNoJump) {
  PoseGate gate({.max_speed = 0.5});
  EXPECT_FALSE(gate.Refuse(OnAxis(0.0), After(0.0)));
  EXPECT_TRUE(gate.Refuse(OnAxis(100.0), After(1000.0)));
}

TEST(PoseGate, AClockThatStartsAgainIsNoJump) {
  PoseGate gate({});
  EXPECT_FALSE(gate.Refuse(OnAxis(0.0), After(100.0)));
  EXPECT_FALSE(gate.Refuse(OnAxis(3.0), After(0.0)));
}

}  // namespace
}  // namespace thalweg::controller
