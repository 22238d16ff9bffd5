#include "common/geometry/spread_directions.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(SpreadDirections, AreUnitVectorsOfWhichEachHasItsShareOfTheSphere) {
  constexpr std::size_t kCount = 400;
  const std::vector<Eigen::Vector3d> directions = SpreadDirections(kCount);
  ASSERT_EQ(directions.size(), kCount);
  // A spherical cap with half-angle a covers the share (1 - cos a) / 2 of the sphere.
  const double cos_cap = std::cos(0.5);
  for (const Eigen::Vector3d& axis : SpreadDirections(37)) {
    EXPECT_NEAR(axis.norm(), 1.0, 1e-12);
    int inside = 0;
    for (const Eigen::Vector3d& direction : directions) inside += direction.dot(axis) >= cos_cap ? 1 : 0;
    EXPECT_NEAR(inside / double{kCount}, 0.5 * (1.0 - cos_cap), 0.01);
  }
}

TEST(SpreadDirections, AddUpToNothing) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : SpreadDirections(1000)) sum += direction;
  EXPECT_LT(sum.norm() / 1000, 1e-3);
}

}  // namespace
}  // namespace thalweg
