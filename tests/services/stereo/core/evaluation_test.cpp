#include "services/stereo/core/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace thalweg::stereo {
namespace {

using testing::ElementsAre;

DisparityMap Row(const std::vector<float>& values) {
  DisparityMap map(static_cast<int>(values.size()), 1);
  map.data() = values;
  return map;
}
constexpr float kGap = kNoDisparity;

TEST(FillGaps, TakesTheLowerNeighborAlongTheRow) {
  EXPECT_THAT(FillGaps(Row({5, kGap, kGap, 3, kGap, 4})).data(), ElementsAre(5, 3, 3, 3, 3, 4));
}

TEST(FillGaps, TakesTheOnlyNeighborAtTheBorder) {
  EXPECT_THAT(FillGaps(Row({kGap, 7, kGap})).data(), ElementsAre(7, 7, 7));
  EXPECT_THAT(FillGaps(Row({kGap, kGap})).data(), ElementsAre(0, 0));
}

TEST(MasksFrom, NonOccludedIsWhereBothTruthsAgree) {
  // A foreground of disparity 2 at pixels 4 and 5 hides background pixels 2 and 3 from the right camera.
  const DisparityMap left = Row({0, 0, 0, 0, 2, 2, 0, kGap});
  const DisparityMap right = Row({0, 0, 2, 2, kGap, kGap, 0, 0});
  const EvaluationMasks masks = MasksFrom(left, right);
  EXPECT_THAT(masks.all.data(), ElementsAre(255, 255, 255, 255, 255, 255, 255, 0));
  EXPECT_THAT(masks.non_occluded.data(), ElementsAre(255, 255, 0, 0, 255, 255, 255, 0));
}

TEST(MasksFrom, FromTheLeftTruthAloneNonOccludedIsWhatNothingNearerHides) {
  const DisparityMap left = Row({0, 0, 0, 0, 2, 2, 0, kGap});
  EXPECT_THAT(MasksFrom(left, std::nullopt).non_occluded.data(),
              ElementsAre(255, 255, 0, 0, 255, 255, 255, 0));
  // Points to the left of the right image are not visible.
  EXPECT_THAT(MasksFrom(Row({2, 2, 2, 2}), std::nullopt).non_occluded.data(), ElementsAre(0, 0, 255, 255));
}

TEST(MasksFrom, NearADiscontinuityIsWithinFourPixelsOfAJump) {
  DisparityMap truth(21, 1, 1, 1.0F);
  for (int u = 10; u < 21; ++u) truth(u, 0) = 5.0F;  // jumps from 9 to 10
  const EvaluationMasks masks = MasksFrom(truth, std::nullopt);
  // 6 to 9 are near the jump, too, but hidden from the right camera by what begins at 10.
  for (int u = 0; u < 21; ++u) {
    EXPECT_EQ(masks.near_discontinuities(u, 0) != 0, u == 5 || (u >= 10 && u <= 13)) << u;
  }
}

TEST(Evaluate, CountsWhatIsOffByMoreThanTheThreshold) {
  const DisparityMap truth = Row({4, 4, 4, 4, kGap});
  EvaluationMasks masks = MasksFrom(truth, std::nullopt);
  masks.non_occluded.data() = {255, 255, 255, 0, 0};
  masks.near_discontinuities.data() = {0, 255, 255, 0, 0};
  const Evaluation e = Evaluate(Row({5, 5.1F, kGap, 9, 9}), truth, masks);
  // Filled: 5, 5.1, 5.1, 9, 9
  EXPECT_DOUBLE_EQ(e.bad_non_occluded, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(e.bad_near_discontinuities, 1.0);
  EXPECT_DOUBLE_EQ(e.bad_all, 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(e.density, 4.0 / 5.0);
  EXPECT_DOUBLE_EQ(e.bad_matched, 2.0 / 3.0);
}

TEST(Evaluate, ReportsNothingWhereThereIsNothingToJudgeBy) {
  const DisparityMap truth = Row({4, 4, 4, 4, 4, 4});
  const Evaluation e = Evaluate(Row({4, 4, 4, 4, 4, 4}), truth, MasksFrom(truth, std::nullopt));
  EXPECT_EQ(e.bad_non_occluded, 0.0);
  EXPECT_TRUE(std::isnan(e.bad_near_discontinuities)) << "no jump in it";
  EXPECT_TRUE(
      std::isnan(Evaluate(Row({kGap, kGap, kGap, kGap, kGap, kGap}), truth, MasksFrom(truth, std::nullopt))
                     .bad_matched));
}

}  // namespace
}  // namespace thalweg::stereo
