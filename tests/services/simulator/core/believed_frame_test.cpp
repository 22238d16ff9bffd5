#include "services/simulator/core/believed_frame.h"

#include <gtest/gtest.h>

#include "tests/support/at_second.h"

namespace thalweg::simulator {
namespace {

using test::AtSecond;

RigidTransform LevelAt(double x, double yaw) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, 1.0, 0.5});
}

TEST(BelievedFrame, IsTheTrueOneUntilSomethingIsBelieved) {
  BelievedFrame frame;
  frame.Note(AtSecond(1.0), LevelAt(0.0, 0.0));
  EXPECT_TRUE(frame.TrueOf(LevelAt(1.0, 0.2)).isApprox(LevelAt(1.0, 0.2)));
}

TEST(BelievedFrame, ARobotSentToWhereItBelievesToBeStays) {
  BelievedFrame frame;
  frame.Note(AtSecond(1.0), LevelAt(0.0, 0.0));
  frame.Note(AtSecond(1.1), LevelAt(0.3, 0.1));
  frame.Believe(AtSecond(1.0), LevelAt(0.2, -0.4));
  EXPECT_TRUE(frame.TrueOf(LevelAt(0.2, -0.4)).isApprox(LevelAt(0.0, 0.0)));
  const RigidTransform forwards = MakeTransform(Eigen::Matrix3d::Identity(), {0.5, 0.0, 0.0});
  EXPECT_TRUE(frame.TrueOf(LevelAt(0.2, -0.4) * forwards).isApprox(LevelAt(0.0, 0.0) * forwards))
      << "it moves in its own axes";
}

TEST(BelievedFrame, WordsOfMomentsThatAreNotRememberedChangeNothing) {
  BelievedFrame frame;
  for (int k = 0; k <= 30; ++k) frame.Note(AtSecond(0.1 * k), LevelAt(0.0, 0.0));
  frame.Believe(AtSecond(0.5), LevelAt(1.0, 0.0));   // too long ago
  frame.Believe(AtSecond(3.05), LevelAt(1.0, 0.0));  // never noted
  EXPECT_TRUE(frame.TrueOf(LevelAt(0.0, 0.0)).isApprox(LevelAt(0.0, 0.0)));
}

}  // namespace
}  // namespace thalweg::simulator
