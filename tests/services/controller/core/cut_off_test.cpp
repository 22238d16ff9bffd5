#include "services/controller/core/cut_off.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/at_second.h"

namespace thalweg::controller {
namespace {

using thalweg::test::AtSecond;

/// Flies 10 m along x; the explorer was last heard at 8 m, after 100 s.
CutOff FlownTenMeters(const CutOff::Options& options) {
  CutOff cut_off(options);
  for (int k = 0; k <= 1000; ++k) {
    cut_off.Note(MakeTransform(Eigen::Matrix3d::Identity(), {0.01 * k, 0.0, 0.0}));
    if (k <= 800) cut_off.Heard(AtSecond(0.125 * k));
  }
  return cut_off;
}

double EndOf(const std::optional<std::vector<RigidTransform>>& path) {
  return path && !path->empty() ? path->back().translation().x() : -1.0;
}

TEST(CutOff, RetreatsToWhereTheExplorerWasLastHeardAndThenStepByStepToTheBeginning) {
  CutOff cut_off = FlownTenMeters({.action = OnCutOff::kRetreat, .after = 5.0, .step = 3.0});
  EXPECT_FALSE(cut_off.PathBack(AtSecond(104.9)));
  EXPECT_NEAR(EndOf(cut_off.PathBack(AtSecond(105.0))), 8.0, 0.011);
  EXPECT_EQ(cut_off.place(), BackPlace::kLastHeard);
  cut_off.EndPathBack(0.0, AtSecond(110.0));
  EXPECT_FALSE(cut_off.PathBack(AtSecond(114.9)));
  EXPECT_NEAR(EndOf(cut_off.PathBack(AtSecond(115.0))), 5.0, 0.011);
  EXPECT_EQ(cut_off.place(), BackPlace::kFartherBack);
  cut_off.EndPathBack(0.0, AtSecond(120.0));
  EXPECT_NEAR(EndOf(cut_off.PathBack(AtSecond(125.0))), 2.0, 0.011);
  cut_off.EndPathBack(0.0, AtSecond(130.0));
  EXPECT_NEAR(EndOf(cut_off.PathBack(AtSecond(135.0))), 0.0, 1e-9);
  cut_off.EndPathBack(0.0, AtSecond(140.0));
  EXPECT_FALSE(cut_off.PathBack(AtSecond(1000.0)));
  EXPECT_EQ(cut_off.place(), BackPlace::kBeginning);
}

TEST(CutOff, GoesHomeAtOnceIfThatIsWanted) {
  CutOff cut_off = FlownTenMeters({.action = OnCutOff::kHome, .after = 30.0});
  EXPECT_FALSE(cut_off.PathBack(AtSecond(129.9)));
  EXPECT_NEAR(EndOf(cut_off.PathBack(AtSecond(130.0))), 0.0, 1e-9);
  EXPECT_EQ(cut_off.place(), BackPlace::kBeginning);
}

TEST(CutOff, StandsIfThatIsWanted) {
  CutOff cut_off = FlownTenMeters({.action = OnCutOff::kStand});
  EXPECT_FALSE(cut_off.PathBack(AtSecond(10'000.0)));
  EXPECT_FALSE(cut_off.place());
}

TEST(CutOff, APathBackThatIsInterruptedGoesOnFromThereTheNextTime) {
  CutOff cut_off = FlownTenMeters({.action = OnCutOff::kHome, .after = 5.0});
  ASSERT_TRUE(cut_off.PathBack(AtSecond(105.0)));
  cut_off.EndPathBack(4.0, AtSecond(108.0));
  cut_off.Heard(AtSecond(108.0));
  EXPECT_FALSE(cut_off.place());
  EXPECT_FALSE(cut_off.PathBack(AtSecond(112.9)));
  const auto path = cut_off.PathBack(AtSecond(113.0));
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->front().translation().x(), 4.0, 1e-9);
  EXPECT_NEAR(EndOf(path), 0.0, 1e-9);
}

TEST(CutOff, AClockThatStartsAgainDoesNotKeepItFromGoingBack) {
  CutOff cut_off = FlownTenMeters({.action = OnCutOff::kHome, .after = 5.0});
  EXPECT_FALSE(cut_off.PathBack(AtSecond(1.0)));
  EXPECT_TRUE(cut_off.PathBack(AtSecond(6.0)));
}

TEST(CutOff, RefusesOptionsThatMakeNoSense) {
  EXPECT_THROW(CutOff({.after = 0.0}), std::invalid_argument);
  EXPECT_THROW(CutOff({.step = -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::controller
