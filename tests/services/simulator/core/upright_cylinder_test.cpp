#include "services/simulator/core/upright_cylinder.h"

#include <gtest/gtest.h>

#include "tests/services/simulator/core/simple_scenes.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

using test::RandomPoint;
using Point = Eigen::Vector3d;

constexpr double kResolution = 1e-7;

UprightCylinder RandomCylinder(std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.05, 0.8);
  return {RandomPoint(random, 1.5), size(random), 2.0 * size(random)};
}

/// Triangles of all kinds: tilted ones, walls, floors, slivers, segments and points.
Triangle RandomTriangle(std::mt19937& random, int kind) {
  const Point middle = RandomPoint(random, 1.5);
  Triangle triangle;
  for (Point& corner : triangle) corner = middle + RandomPoint(random, 0.7);
  if (kind == 1) triangle[1].head<2>() = triangle[0].head<2>();
  if (kind == 2) triangle[1].z() = triangle[2].z() = triangle[0].z();
  if (kind == 3) triangle[2] = 0.3 * triangle[0] + 0.7 * triangle[1] + RandomPoint(random, 1e-4);
  if (kind == 4) triangle[2] = triangle[1];
  if (kind == 5) triangle[1] = triangle[2] = triangle[0];
  return triangle;
}

double DistanceToPoint(const UprightCylinder& cylinder, const Point& p) {
  const Point offset = p - cylinder.center;
  return std::max(offset.head<2>().norm() - cylinder.radius, std::abs(offset.z()) - 0.5 * cylinder.height);
}

TEST(UprightCylinder, DistanceToATriangleIsThatToItsNearestPoint) {
  std::mt19937 random(1);
  constexpr int kCells = 60;
  for (int n = 0; n < 1200; ++n) {
    const UprightCylinder cylinder = RandomCylinder(random);
    const Triangle triangle = RandomTriangle(random, n % 6);
    const auto& [a, b, c] = triangle;
    double sampled = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kCells; ++i) {
      for (int j = 0; i + j <= kCells; ++j) {
        const Point p = a + (double(i) / kCells) * (b - a) + (double(j) / kCells) * (c - a);
        sampled = std::min(sampled, DistanceToPoint(cylinder, p));
      }
    }
    // No point of a triangle is farther from a grid point than a cell's longest side.
    const double cell = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()}) / kCells;
    const double distance = Distance(cylinder, triangle, 10.0);
    ASSERT_LE(distance, sampled + 1e-8) << n;
    ASSERT_GE(distance, sampled - cell - kResolution) << n;
    ASSERT_GE(distance, -std::min(cylinder.radius, 0.5 * cylinder.height)) << n;
  }
}

TEST(UprightCylinder, DistanceToAPlaneIsWhereTheGrownCylinderTouchesIt) {
  std::mt19937 random(2);
  int tilted_inside = 0;
  for (int n = 0; n < 500; ++n) {
    const UprightCylinder cylinder = RandomCylinder(random);
    const Point normal = test::RandomDirection(random);
    const double away = std::uniform_real_distribution<double>(0.0, 2.0)(random);
    const Point foot = cylinder.center + away * normal;
    const Point side = 100.0 * normal.unitOrthogonal();
    const Triangle plane = {foot + side, foot - 0.5 * side + normal.cross(side),
                            foot - 0.5 * side - normal.cross(side)};
    // The cylinder grown by k reaches this far along the normal: (r + k) beside and (h / 2 + k) above.
    const double beside = normal.head<2>().norm();
    const double above = std::abs(normal.z());
    const double touching =
        (away - beside * cylinder.radius - above * 0.5 * cylinder.height) / (beside + above);
    const double expected = std::max(touching, -std::min(cylinder.radius, 0.5 * cylinder.height));
    ASSERT_NEAR(Distance(cylinder, plane, 10.0), expected, 2.0 * kResolution) << n;
    tilted_inside += touching < 0.0;
  }
  EXPECT_GT(tilted_inside, 50);
}

TEST(UprightCylinder, WallsFloorsAndEdgesHaveTheirPlainDistances) {
  const UprightCylinder cylinder{{0, 0, 0.35}, 0.17, 0.4};
  const Triangle wall = {Point(1, -5, 0), Point(1, 5, 0), Point(1, 5, 3)};
  const Triangle floor = {Point(-9, -9, 0), Point(9, -9, 0), Point(0, 9, 0)};
  const Triangle table = {Point(0.5, -9, 0.6), Point(0.5, 9, 0.6), Point(9, 0, 0.6)};
  EXPECT_NEAR(Distance(cylinder, wall, 10.0), 0.83, kResolution);
  EXPECT_NEAR(Distance(cylinder, floor, 10.0), 0.15, kResolution);
  EXPECT_NEAR(Distance(cylinder, table, 10.0), 0.33, kResolution) << "beside it, whatever its height";
  UprightCylinder below = cylinder;
  below.center.x() = 2.0;
  EXPECT_NEAR(Distance(below, table, 10.0), 0.05, kResolution);
  below.height = 0.6;
  EXPECT_NEAR(Distance(below, table, 10.0), -0.05, kResolution);
}

TEST(UprightCylinder, InLineWithAWallSeenFromItsEdgeItIsBesideTheWall) {
  const Triangle wall = {Point(1, 0.5, 0), Point(3, 1.5, 0), Point(1, 0.5, 2)};
  for (double along = -2.0; along < 0.99; along += 0.0625) {
    const UprightCylinder cylinder{{along, 0.5 * along, 1.0}, 0.1, 0.5};
    EXPECT_NEAR(Distance(cylinder, wall, 10.0), (1.0 - along) * std::sqrt(1.25) - 0.1, kResolution) << along;
  }
}

TEST(UprightCylinder, ChangesByNoMoreThanTheCylinderMoves) {
  std::mt19937 random(3);
  for (int n = 0; n < 3000; ++n) {
    UprightCylinder cylinder = RandomCylinder(random);
    const Triangle triangle = RandomTriangle(random, n % 6);
    const double before = Distance(cylinder, triangle, 10.0);
    const Point offset = RandomPoint(random, n % 2 == 0 ? 0.3 : 0.01);
    cylinder.center += offset;
    const double most = std::max(offset.head<2>().norm(), std::abs(offset.z()));
    ASSERT_LE(std::abs(Distance(cylinder, triangle, 10.0) - before), most + 2.0 * kResolution);
  }
}

TEST(UprightCylinder, DistanceEndsAtTheLimit) {
  std::mt19937 random(4);
  for (int n = 0; n < 1000; ++n) {
    const UprightCylinder cylinder = RandomCylinder(random);
    const Triangle triangle = RandomTriangle(random, n % 6);
    const double distance = Distance(cylinder, triangle, 10.0);
    ASSERT_NEAR(Distance(cylinder, triangle, distance + 0.1), distance, 2.0 * kResolution);
    ASSERT_EQ(Distance(cylinder, triangle, distance - 0.01), distance - 0.01);
  }
}

TEST(UprightCylinder, DistanceToABoxIsThatToItsNearestPoint) {
  std::mt19937 random(5);
  constexpr int kCells = 20;
  for (int n = 0; n < 200; ++n) {
    const UprightCylinder cylinder = RandomCylinder(random);
    Eigen::AlignedBox3d box(RandomPoint(random, 1.0));
    box.extend(RandomPoint(random, 1.0));
    double sampled = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kCells; ++i) {
      for (int j = 0; j <= kCells; ++j) {
        for (int k = 0; k <= kCells; ++k) {
          const Point share = Point(i, j, k) / kCells;
          sampled = std::min(sampled, DistanceToPoint(cylinder, box.min() + share.cwiseProduct(box.sizes())));
        }
      }
    }
    const double distance = Distance(cylinder, box);
    ASSERT_LE(distance, sampled + 1e-12);
    ASSERT_GE(distance, sampled - box.sizes().norm() / kCells);
  }
}

}  // namespace
}  // namespace thalweg::simulator
