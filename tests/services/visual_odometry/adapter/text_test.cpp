#include "services/visual_odometry/adapter/text.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace thalweg::visual_odometry {
namespace {

using Kind = Reason::Kind;

TEST(ReasonText, SaysWhatIsWrongAndByHowMuch) {
  EXPECT_EQ(ReasonText({}), "");
  EXPECT_EQ(ReasonText({.kind = Kind::kDark, .amount = 3.14, .eye = Eye::kRight}),
            "right image is dark: mean 3.1");
  EXPECT_EQ(ReasonText({.kind = Kind::kBlank, .amount = 0.52, .eye = Eye::kLeft}),
            "left image shows nothing (covered?): contrast 0.5");
  EXPECT_EQ(ReasonText({.kind = Kind::kFrozen, .eye = Eye::kLeft}),
            "left image is unchanged since the previous frame");
  EXPECT_EQ(ReasonText({.kind = Kind::kFrozen, .eye = Eye::kBoth}),
            "both images are unchanged since the previous frame");
  EXPECT_EQ(ReasonText({.kind = Kind::kBlurred, .amount = 0.4321}),
            "image is blurred: sharpness 43.2 % of its usual value");
  EXPECT_EQ(ReasonText({.kind = Kind::kTimeRunsBackwards, .amount = 0.05}), "time runs backwards by 0.050 s");
  EXPECT_EQ(ReasonText({.kind = Kind::kTooFewPoints, .amount = 7}), "too few points tracked: 7");
  EXPECT_EQ(ReasonText({.kind = Kind::kFewOfVisiblePoints, .amount = 0.26}),
            "only 26 % of the points tracked");
  EXPECT_EQ(ReasonText({.kind = Kind::kPositionUncertain, .amount = 0.0312}),
            "position uncertain by 31 mm since the last keyframe");
  EXPECT_EQ(ReasonText({.kind = Kind::kCalibrationOff, .amount = 0.024, .offset_px = 0.31}),
            "the calibration seems off by about 0.3 px: distances uncertain by 2.4 %");
  EXPECT_EQ(ReasonText({.kind = Kind::kRestarted, .amount = 5.04}), "restarted after 5.0 s without a pose");
}

TEST(ReasonText, HasWordsOfItsOwnForEveryKind) {
  std::set<std::string> texts;
  const int last = static_cast<int>(Kind::kNotRelocalized);
  for (int kind = 0; kind <= last; ++kind) texts.insert(ReasonText({.kind = static_cast<Kind>(kind)}));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(last) + 1);
}

TEST(Fixed, SaysNothingOfWhatIsNoNumber) {
  EXPECT_EQ(Fixed(2.345, 1), "2.3");
  EXPECT_EQ(Fixed(std::numeric_limits<double>::quiet_NaN(), 1), "-");
  EXPECT_EQ(Fixed(std::numeric_limits<double>::infinity(), 0), "-");
}

}  // namespace
}  // namespace thalweg::visual_odometry
