#include "common/geometry/pose_history.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

/// A body that drives along x at 2 m/s and turns left at 0.5 rad/s.
RigidTransform DrivenFor(double seconds) {
  return MakeTransform(RotationFromYawPitch(0.5 * seconds, 0.0), {2.0 * seconds, 0.0, 0.0});
}

PoseHistory TenHertz(double until, const PoseHistory::Options& options = {}) {
  PoseHistory history(options);
  for (int k = 0; k * 0.1 <= until; ++k) EXPECT_TRUE(history.Add(At(k * 0.1), DrivenFor(k * 0.1)));
  return history;
}

TEST(PoseHistory, InterpolatesBetweenThePosesAroundTheStamp) {
  const PoseHistory history = TenHertz(2.0);
  for (double t = 0.0; t <= 2.0; t += 0.013) {
    const Result<RigidTransform> T_WB = history.At(At(t));
    ASSERT_TRUE(T_WB) << T_WB.error();
    EXPECT_TRUE(T_WB->isApprox(DrivenFor(t), 1e-8)) << t;
  }
}

TEST(PoseHistory, RefusesStampsBeforeAfterAndWithoutAnyPose) {
  EXPECT_EQ(PoseHistory().At(At(1.0)).error(), "no pose yet");
  const PoseHistory history = TenHertz(1.0);
  EXPECT_NE(history.At(At(-0.5)).error().find("0.5"), std::string::npos);
  EXPECT_NE(history.At(At(1.5)).error().find("after the newest"), std::string::npos);
  EXPECT_TRUE(history.Reaches(At(1.0)));
  EXPECT_FALSE(history.Reaches(At(1.01)));
}

TEST(PoseHistory, DoesNotInterpolateAcrossAHole) {
  PoseHistory history;
  ASSERT_TRUE(history.Add(At(0.0), DrivenFor(0.0)));
  ASSERT_TRUE(history.Add(At(0.3), DrivenFor(0.3)));
  EXPECT_FALSE(history.At(At(0.1)));
  EXPECT_TRUE(history.At(At(0.3)));
}

TEST(PoseHistory, IgnoresTimeThatGoesBackwards) {
  PoseHistory history = TenHertz(1.0);
  EXPECT_FALSE(history.Add(At(0.5), DrivenFor(9.0)));
  EXPECT_FALSE(history.Add(At(1.0), DrivenFor(9.0)));
  EXPECT_TRUE(history.At(At(1.0))->isApprox(DrivenFor(1.0), 1e-9));
}

TEST(PoseHistory, ForgetsWhatIsOlderThanItsLength) {
  const PoseHistory history = TenHertz(3.0, {.length = FromSeconds(1.0), .max_gap = FromSeconds(0.25)});
  EXPECT_FALSE(history.At(At(1.5)));
  EXPECT_TRUE(history.At(At(2.5)));
}

}  // namespace
}  // namespace thalweg
