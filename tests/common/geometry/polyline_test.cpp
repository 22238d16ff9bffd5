#include "common/geometry/polyline.h"

#include <gtest/gtest.h>

#include "common/geometry/rigid_transform.h"

namespace thalweg {
namespace {

const Eigen::Vector3d kA(1.0, 2.0, 3.0);
const Eigen::Vector3d kB(1.0, 2.0, 4.0);

std::vector<Eigen::Vector3d> Points(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double step) {
  std::vector<Eigen::Vector3d> points;
  EXPECT_TRUE(ForEachPointAlong(a, b, step, [&](const Eigen::Vector3d& p) {
    points.push_back(p);
    return true;
  }));
  return points;
}

TEST(ForEachPointAlong, DividesASegmentIntoTheFewestEqualPiecesThatAreShortEnough) {
  for (const double step : {0.24, 0.25, 0.3, 1.0, 7.0}) {
    const std::vector<Eigen::Vector3d> points = Points(kA, kB, step);
    const auto pieces = static_cast<double>(points.size());
    EXPECT_LE(1.0 / pieces, step + 1e-12);
    if (points.size() > 1) {
      EXPECT_GT(1.0 / (pieces - 1.0), step);
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
      EXPECT_NEAR((points[n] - kA).norm(), static_cast<double>(n + 1) / pieces, 1e-12);
    }
    EXPECT_EQ(points.back(), kB);
  }
  EXPECT_EQ(Points(kA, kA, 0.1).size(), 1U);
}

TEST(ForEachPointAlong, EndsWhenItsVisitorHasEnough) {
  int visits = 0;
  EXPECT_FALSE(ForEachPointAlong(kA, kB, 0.1, [&](const Eigen::Vector3d&) { return ++visits < 3; }));
  EXPECT_EQ(visits, 3);
}

TEST(PathLength, IsTheSumOfTheSegments) {
  EXPECT_EQ(PathLength(std::vector<Eigen::Vector3d>{}), 0.0);
  EXPECT_EQ(PathLength(std::vector<Eigen::Vector3d>{kA}), 0.0);
  const std::vector<Eigen::Vector3d> path = {kA, kB, kB + Eigen::Vector3d(3.0, 4.0, 0.0)};
  EXPECT_DOUBLE_EQ(PathLength(path), 6.0);
  std::vector<RigidTransform> poses;
  for (const Eigen::Vector3d& p : path) poses.push_back(MakeTransform(Eigen::Matrix3d::Identity(), p));
  EXPECT_DOUBLE_EQ(PathLength(poses), 6.0);
}

}  // namespace
}  // namespace thalweg
