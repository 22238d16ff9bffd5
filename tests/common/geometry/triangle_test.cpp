#include "common/geometry/triangle.h"

#include <gtest/gtest.h>

#include <random>

namespace thalweg {
namespace {

const Eigen::AlignedBox3d kUnit(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 1));

/// A triangle in the plane z = `height` that covers the unit box from above.
Triangle Above(double height) {
  return {Eigen::Vector3d(-5, -5, height), Eigen::Vector3d(9, -5, height), Eigen::Vector3d(-5, 9, height)};
}

double AreaOf(const std::vector<Eigen::Vector3d>& polygon) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    area += 0.5 * (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  }
  return area.norm();
}

TEST(Triangle, OverlapIsAsDeepAsAPlaneLiesInsideTheBox) {
  EXPECT_NEAR(OverlapDepth(Above(0.8), kUnit), 0.2, 1e-12);
  EXPECT_NEAR(OverlapDepth(Above(1.0), kUnit), 0.0, 1e-12);
  EXPECT_NEAR(OverlapDepth(Above(1.3), kUnit), -0.3, 1e-12);
  EXPECT_NEAR(OverlapDepth(Above(-0.1), kUnit), -0.1, 1e-12);
}

TEST(Triangle, ACornerCutOffByASlantedPlaneIsFoundByItsNormalAlone) {
  // The plane x + y + z = 3 - d lies at distance d / sqrt(3) from the corner (1, 1, 1).
  const auto slanted = [](double d) {
    const double s = 3.0 - d;
    return Triangle{Eigen::Vector3d(s + 8, -4, -4), Eigen::Vector3d(-4, s + 8, -4),
                    Eigen::Vector3d(-4, -4, s + 8)};
  };
  EXPECT_NEAR(OverlapDepth(slanted(0.3), kUnit), 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(OverlapDepth(slanted(-0.3), kUnit), -0.3 / std::sqrt(3.0), 1e-12);
}

TEST(Triangle, OverlapsExactlyWhereClippingLeavesAPart) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1.0, 2.0);
  const auto point = [&] {
    return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random));
  };
  int overlapping = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle triangle = {point(), point(), point()};
    const double depth = OverlapDepth(triangle, kUnit);
    if (std::abs(depth) < 1e-9) continue;
    ASSERT_EQ(depth > 0.0, !ClipToBox(triangle, kUnit).empty()) << i;
    overlapping += depth > 0.0;
  }
  EXPECT_GT(overlapping, 2000);
  EXPECT_LT(overlapping, 18000);
}

TEST(Triangle, ClippedPartLiesInTheBoxAndHasItsArea) {
  const auto part = ClipToBox(Above(0.5), kUnit);
  EXPECT_NEAR(AreaOf(part), 1.0, 1e-12);
  for (const Eigen::Vector3d& corner : part) EXPECT_TRUE(kUnit.contains(corner));
}

TEST(Triangle, DistanceIsRightOverFaceEdgeAndCorner) {
  const Triangle triangle = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)};
  EXPECT_NEAR(DistanceToTriangle({0.2, 0.2, -0.7}, triangle), 0.7, 1e-12);
  EXPECT_NEAR(DistanceToTriangle({0.5, -3, 4}, triangle), 5.0, 1e-12);
  EXPECT_NEAR(DistanceToTriangle({-1, -1, 1}, triangle), std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(DistanceToTriangle({1, 1, 0}, triangle), std::sqrt(0.5), 1e-12);
}

TEST(Triangle, ATriangleWithoutAreaIsASegment) {
  const Triangle segment = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(2, 0, 0)};
  EXPECT_NEAR(DistanceToTriangle({1.5, 3, 4}, segment), 5.0, 1e-12);
  EXPECT_NEAR(DistanceToTriangle({5, 4, 0}, segment), 5.0, 1e-12);
}

}  // namespace
}  // namespace thalweg
