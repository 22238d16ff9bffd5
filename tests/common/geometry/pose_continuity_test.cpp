#include "common/geometry/pose_continuity.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

using Verdict = PoseContinuity::Verdict;

Time SecondAt(double seconds) {
  return Time{FromSeconds(seconds)};
}
RigidTransform PoseAt(double x, double yaw = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, 0.0, 0.0});
}

TEST(PoseContinuity, APoseThatJumpsIsNotUsedAndTheTrackGoesOn) {
  PoseContinuity continuity({.max_speed = 1.0, .max_turn_rate = 1.0, .allowance = 0.05});
  EXPECT_EQ(continuity.Judge(SecondAt(0.0), PoseAt(0.0)), Verdict::kFollows);
  EXPECT_EQ(continuity.Judge(SecondAt(0.1), PoseAt(0.1)), Verdict::kFollows);
  EXPECT_EQ(continuity.Judge(SecondAt(0.2), PoseAt(2.0)), Verdict::kJumps);
  EXPECT_EQ(continuity.Judge(SecondAt(0.3), PoseAt(0.3)), Verdict::kFollows);
  EXPECT_EQ(continuity.Judge(SecondAt(0.4), PoseAt(0.4, 1.0)), Verdict::kJumps)
      << "turned by a radian in 0.1 s";
  EXPECT_EQ(continuity.Judge(SecondAt(0.5), PoseAt(0.5)), Verdict::kFollows);
}

TEST(PoseContinuity, WhatFollowsOnTheJumpIsANewTrack) {
  PoseContinuity continuity({.max_speed = 1.0, .max_turn_rate = 1.0, .allowance = 0.05});
  continuity.Judge(SecondAt(0.0), PoseAt(0.0));
  EXPECT_EQ(continuity.Judge(SecondAt(0.1), PoseAt(3.0)), Verdict::kJumps);
  EXPECT_EQ(continuity.Judge(SecondAt(0.2), PoseAt(3.05)), Verdict::kNewTrack);
  EXPECT_EQ(continuity.Judge(SecondAt(0.3), PoseAt(3.1)), Verdict::kFollows);
}

TEST(PoseContinuity, ForgetsWhatWasBefore) {
  PoseContinuity continuity({});
  continuity.Judge(SecondAt(5.0), PoseAt(0.0));
  continuity.Forget();
  EXPECT_EQ(continuity.Judge(SecondAt(0.1), PoseAt(9.0)), Verdict::kFollows);
}

}  // namespace
}  // namespace thalweg
