#include "services/stereo/core/row_alignment.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

using testing::HasSubstr;

/// Images of a plane of texture whose disparity grows from left to right; the right one's rows are off.
struct Pair {
  explicit Pair(const RowAlignment& off, unsigned seed = 1) : left(kWidth, kHeight), right(kWidth, kHeight) {
    const test::Texture texture(seed);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        left(u, v) = static_cast<std::uint8_t>(texture.At(u, v) + 0.5);
        // What is at u here is at u + d in the left image.
        const double in_left = (u + 5.0) / (1.0 - 0.03);
        const double x = (in_left + 0.5) / kWidth - 0.5;
        double row = v;
        for (int k = 0; k < 5; ++k) row = v - off.AtPx(x, (row + 0.5) / kHeight - 0.5);
        right(u, v) = static_cast<std::uint8_t>(texture.At(in_left, row) + 0.5);
      }
    }
  }
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  ByteImage left, right;
};

TEST(RowAlignment, IsMeasuredToATwentiethOfAPixel) {
  for (const RowAlignment& off :
       {RowAlignment{}, RowAlignment{.offset_px = 0.3}, RowAlignment{.offset_px = -1.7, .tilt_px = 1.1},
        RowAlignment{.offset_px = 4.4, .tilt_px = -0.6, .slant_px = 0.9}}) {
    const Pair pair(off);
    const auto rows = MeasureRowAlignment(pair.left, pair.right, 32);
    ASSERT_TRUE(rows);
    EXPECT_GT(rows->corners, 100U);
    EXPECT_NEAR(rows->offset_px, off.offset_px, 0.05);
    EXPECT_NEAR(rows->tilt_px, off.tilt_px, 0.1);
    EXPECT_NEAR(rows->slant_px, off.slant_px, 0.1);
    EXPECT_LT(std::sqrt(rows->covariance_px2(0, 0)), 0.02);
  }
}

TEST(RowAlignment, ImagesThatShowDifferentThingsHaveNone) {
  const Pair a(RowAlignment{}, 1);
  const Pair b(RowAlignment{}, 2);
  EXPECT_FALSE(MeasureRowAlignment(a.left, b.right, 32));
  EXPECT_FALSE(MeasureRowAlignment(ByteImage(Pair::kWidth, Pair::kHeight),
                                   ByteImage(Pair::kWidth, Pair::kHeight), 32));
  EXPECT_FALSE(MeasureRowAlignment(ByteImage(16, 8), ByteImage(16, 8), 32));
}

TEST(RowAlignment, OnlyWhatIsCertainCounts) {
  RowAlignment rows{.corners = 100, .offset_px = 0.6, .tilt_px = 0.4};
  EXPECT_NEAR(rows.CertainPx(), 0.8, 1e-12);
  rows.covariance_px2(0, 0) = 0.01;
  EXPECT_NEAR(rows.CertainPx(), 0.5, 1e-12);
}

TEST(RowAlignment, IsDescribedForPeople) {
  EXPECT_EQ(Describe(RowAlignment{.corners = 312, .offset_px = 0.1, .tilt_px = 0.1}),
            "rows agree within 0.15 px (312 corners)");
  EXPECT_THAT(Describe(RowAlignment{.corners = 312, .offset_px = 0.8, .tilt_px = -0.4}),
              HasSubstr("differ by up to 1.0 px: +0.80 in the middle, -0.40 more from left to right"));
}

TEST(RowMonitor, WarnsOnceWhenSeveralPairsInARowAgreeOnIt) {
  const RowAlignment good{.corners = 100, .offset_px = 0.1};
  const RowAlignment bad{.corners = 100, .offset_px = 1.0};
  RowMonitor monitor;
  EXPECT_FALSE(monitor.Add(bad));
  EXPECT_FALSE(monitor.Add(bad));
  EXPECT_FALSE(monitor.Add(good));
  EXPECT_FALSE(monitor.Add(bad));
  EXPECT_FALSE(monitor.Add(bad));
  const auto warning = monitor.Add(bad);
  ASSERT_TRUE(warning);
  EXPECT_THAT(*warning, HasSubstr("differ"));
  for (int k = 0; k < 10; ++k) EXPECT_FALSE(monitor.Add(bad));
  EXPECT_FALSE(monitor.Add(good));
  EXPECT_FALSE(monitor.Add(good));
  EXPECT_THAT(*monitor.Add(good), HasSubstr("agree"));
}

}  // namespace
}  // namespace thalweg::stereo
