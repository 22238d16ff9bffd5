#include "services/stereo/core/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/services/stereo/support/slow_reference.h"

namespace thalweg::stereo {
namespace {

class RemoveSmallRegionsBy : public testing::TestWithParam<Connectivity> {};

TEST_P(RemoveSmallRegionsBy, EqualsFloodingOnRandomMaps) {
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    DisparityMap disparity(31, 22);
    std::uniform_int_distribution<int> value(0, 3);
    for (float& d : disparity.data()) {
      const int k = value(random);
      d = k == 3 ? kNoDisparity : static_cast<float>(k) * 1.1F;
    }
    const DisparityMap expected = test::SlowlyRemoved(disparity, 5, 1.2F, GetParam());
    RemoveSmallRegions(disparity, 5, 1.2F, GetParam());
    EXPECT_THAT(disparity.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), expected.data()));
  }
}

INSTANTIATE_TEST_SUITE_P(FourAndEight, RemoveSmallRegionsBy,
                         testing::Values(Connectivity::kFour, Connectivity::kEight));

TEST(RemoveSmallRegions, ADiagonalIsOneRegionOnlyWhereCornersConnect) {
  for (const int direction : {1, -1}) {
    DisparityMap diagonal(8, 8, 1, kNoDisparity);
    for (int i = 0; i < 6; ++i) diagonal(direction > 0 ? 1 + i : 6 - i, 1 + i) = 7.0F;
    DisparityMap by_edges = diagonal;
    RemoveSmallRegions(by_edges, 6, 1.0F, Connectivity::kFour);
    EXPECT_THAT(by_edges.data(), testing::Each(testing::IsNan()));
    DisparityMap by_corners = diagonal;
    RemoveSmallRegions(by_corners, 6, 1.0F, Connectivity::kEight);
    EXPECT_THAT(by_corners.data(), testing::Pointwise(testing::NanSensitiveFloatEq(), diagonal.data()));
    RemoveSmallRegions(by_corners, 7, 1.0F, Connectivity::kEight);
    EXPECT_THAT(by_corners.data(), testing::Each(testing::IsNan()));
  }
}

TEST(RemoveSmallRegions, RowsDoNotConnectAroundTheImage) {
  DisparityMap ends(6, 4, 1, kNoDisparity);  // the last pixel of a row, the first of those around it
  ends(5, 1) = 3.0F;
  ends(0, 1) = ends(0, 2) = 3.0F;
  RemoveSmallRegions(ends, 3, 1.0F, Connectivity::kEight);
  EXPECT_THAT(ends.data(), testing::Each(testing::IsNan()));
}

TEST(ParabolaVertex, IsThatOfTheParabola) {
  for (const float x : {-0.5F, -0.2F, 0.0F, 0.45F}) {
    const auto parabola = [&](float at) { return 3.0F * (at - x) * (at - x) + 1.0F; };
    EXPECT_NEAR(ParabolaVertex(parabola(-1), parabola(0), parabola(1)), x, 1e-5);
  }
  EXPECT_EQ(ParabolaVertex(4, 4, 4), 0.0F);
}

}  // namespace
}  // namespace thalweg::stereo
