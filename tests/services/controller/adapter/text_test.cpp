#include "services/controller/adapter/text.h"

#include <gtest/gtest.h>

namespace thalweg::controller {
namespace {

TEST(ReasonText, SaysWhereTheRobotGoesOrWaitsAndWhatIsInItsWay) {
  EXPECT_EQ(ReasonText({}), "");
  EXPECT_EQ(ReasonText({.reason = StopReason::kPathSilent}), "path silent");
  EXPECT_EQ(ReasonText({.reason = StopReason::kGoingBack, .back = BackPlace::kLastHeard}),
            "path silent: going back to where the explorer was last heard");
  EXPECT_EQ(ReasonText({.reason = StopReason::kWentBack, .back = BackPlace::kBeginning}),
            "path silent: went back, waiting where it began");
  EXPECT_EQ(
      ReasonText({.reason = StopReason::kThroughSolid, .obstacle_W = Eigen::Vector3d(2.05, -0.05, 1.0)}),
      "path leads through what is known to be solid at (2.05, -0.05, 1.00)");
}

TEST(JumpText, SaysHowFarThePoseJumps) {
  EXPECT_EQ(
      JumpText({.distance = 2.0, .turn = 1.5, .time = 0.02}),
      "jumps by 2.00 m and 86 deg within 0.02 s, faster than the robot moves; believed if it stays there");
}

TEST(ReasonText, HasWordsForEveryReason) {
  const int last = static_cast<int>(StopReason::kWaitingForArrival);
  for (int reason = static_cast<int>(StopReason::kNone) + 1; reason <= last; ++reason) {
    EXPECT_NE(ReasonText({.reason = static_cast<StopReason>(reason),
                          .back = BackPlace::kFartherBack,
                          .obstacle_W = Eigen::Vector3d::Zero()}),
              "")
        << reason;
  }
}

}  // namespace
}  // namespace thalweg::controller
