#include "services/simulator/core/believed_frame.h"

#include <gtest/gtest.h>

namespace thalweg::simulator {
namespace {

Time AtSecond(double second) {
  return Time{} + FromSeconds(second);
}

RigidTransform At(double x, double yaw) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, 1.0, 0.5});
}

TEST(BelievedFrame, IsTheTrueOneUntilSomethingIsBelieved) {
  BelievedFrame frame;
  frame.Note(AtSecond(1.0), At(0.0, 0.0));
  EXPECT_TRUE(frame.TrueOf(At(1.0, 0.2)).isApprox(At(1.0, 0.2)));
}

TEST(BelievedFrame, ARobotSentToWhereItBelievesToBeStays) {
  BelievedFrame frame;
  frame.Note(AtSecond(1.0), At(0.0, 0.0));
  frame.Note(AtSecond(1.1), At(0.3, 0.1));
  frame.Believe(AtSecond(1.0), At(0.2, -0.4));
  EXPECT_TRUE(frame.TrueOf(At(0.2, -0.4)).isApprox(At(0.0, 0.0)));
  const RigidTransform forwards = MakeTransform(Eigen::Matrix3d::Identity(), {0.5, 0.0, 0.0});
  EXPECT_TRUE(frame.TrueOf(At(0.2, -0.4) * forwards).isApprox(At(0.0, 0.0) * forwards))
      << "it moves in its own axes";
}

TEST(BelievedFrame, WordsOfMomentsThatAreNotRememberedChangeNothing) {
  BelievedFrame frame;
  for (int k = 0; k <= 30; ++k) frame.Note(AtSecond(0.1 * k), At(0.0, 0.0));
  frame.Believe(AtSecond(0.5), At(1.0, 0.0));   // too long ago
  frame.Believe(AtSecond(3.05), At(1.0, 0.0));  // never noted
  EXPECT_TRUE(frame.TrueOf(At(0.0, 0.0)).isApprox(At(0.0, 0.0)));
}

}  // namespace
}  // namespace thalweg::simulator
