#include "services/surface/core/fused/place_judge.h"

#include <gtest/gtest.h>

namespace thalweg::surface {
namespace {

using Verdict = PlaceJudge::Verdict;

RigidTransform At(double x, double yaw = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, 0.0, 0.0});
}
constexpr MapAgreement kSame{.agreeing = 900, .contradicting = 20};
constexpr MapAgreement kMisleading{.agreeing = 300, .contradicting = 490};
constexpr MapAgreement kOther{.agreeing = 400, .contradicting = 350};
constexpr MapAgreement kNothing{.agreeing = 3, .contradicting = 5};

TEST(PlaceJudge, IsNotMisledByOneView) {
  PlaceJudge judge;
  EXPECT_EQ(judge.Judge(kMisleading, At(0.0)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kSame, At(0.3)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kSame, At(0.3, 0.4)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kSame, At(0.6)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kSame, At(0.9)), Verdict::kSame);
}

TEST(PlaceJudge, FindsAnotherPlaceByFiveViews) {
  PlaceJudge judge;
  for (int n = 0; n < 4; ++n) EXPECT_EQ(judge.Judge(kOther, At(0.3 * n)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kOther, At(0.3 * 4)), Verdict::kOther);
  EXPECT_EQ(judge.sum().contradicting, 5U * 350U);
}

TEST(PlaceJudge, CountsAViewOnceHoweverLongTheRobotStands) {
  PlaceJudge judge;
  for (int n = 0; n < 30; ++n) EXPECT_EQ(judge.Judge(kMisleading, At(0.001 * n)), Verdict::kUndecided);
  EXPECT_EQ(judge.sum().contradicting, 490U);
}

TEST(PlaceJudge, CountsAViewOnceHoweverOftenTheRobotTurnsToIt) {
  PlaceJudge judge;
  for (int n = 0; n < 40; ++n)
    EXPECT_EQ(judge.Judge(n % 2 == 0 ? kMisleading : kSame, At(0.0, n % 2)), Verdict::kUndecided);
  EXPECT_EQ(judge.sum().contradicting, 490U + 20U);
}

TEST(PlaceJudge, RefusesByThreeViewsAtLeastHoweverLongItTakes) {
  PlaceJudge judge;
  for (int n = 0; n < 200; ++n) EXPECT_EQ(judge.Judge(kMisleading, At(0.0)), Verdict::kUndecided);
  for (int n = 0; n < 200; ++n) EXPECT_EQ(judge.Judge(kNothing, At(1.0 + n)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kOther, At(0.3)), Verdict::kUndecided);
  EXPECT_EQ(judge.Judge(kOther, At(0.6)), Verdict::kOther);
}

TEST(PlaceJudge, TakesThePlaceForTheSameWhereNothingSpeaksAgainstItForLong) {
  PlaceJudge stands;
  for (int n = 0; n < 49; ++n) EXPECT_EQ(stands.Judge(kSame, At(0.0)), Verdict::kUndecided);
  EXPECT_EQ(stands.Judge(kSame, At(0.0)), Verdict::kSame);
  PlaceJudge sees_nothing;
  for (int n = 0; n < 49; ++n) EXPECT_EQ(sees_nothing.Judge(kNothing, At(n)), Verdict::kUndecided);
  EXPECT_EQ(sees_nothing.Judge(kNothing, At(49)), Verdict::kSame);
}

}  // namespace
}  // namespace thalweg::surface
