#include "services/explorer/core/gaps/visibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "tests/services/explorer/support/gap_rooms.h"
#include "tests/services/explorer/support/gap_vertices.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;
using test::VerticesOf;

/// How far one sees in a direction within a closed outline: each wall by itself, with a system of equations.
double RangeWithin(const std::vector<Vector2d>& outline, const Vector2d& from, double direction) {
  double range = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector2d& a = outline[k];
    const Vector2d& b = outline[(k + 1) % outline.size()];
    Eigen::Matrix2d system;
    system << std::cos(direction), a.x() - b.x(), std::sin(direction), a.y() - b.y();
    const Vector2d solution = system.inverse() * (a - from);
    if (solution.x() > 0.0 && solution.y() >= 0.0 && solution.y() <= 1.0)
      range = std::min(range, solution.x());
  }
  return range;
}

double AreaOf(const std::vector<Vector2d>& outline) {
  double twice = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k)
    twice += Cross(outline[k], outline[(k + 1) % outline.size()]);
  return twice / 2.0;
}

/// Calls check(polygon, a viewpoint in it) for random ones of every kind.
template <class Check>
void ForEachRandomViewpoint(Check&& check) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const test::PolygonKind kind : test::kPolygonKinds) {
      const Polygon polygon = test::RandomPolygon(kind, seed);
      test::Dice dice(seed);
      for (int k = 0; k < 5; ++k) check(polygon, test::RandomPointIn(dice, polygon));
    }
  }
}

TEST(Visibility, ACornerHidesWhatItsShadowCovers) {
  const Polygon corridor = test::BentCorridor();
  const Vector2d viewpoint(1.0, 1.0);
  const std::vector<Gap> gaps = SenseGaps(corridor, viewpoint);
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_EQ(gaps[0].vertex, 4U);
  EXPECT_EQ(gaps[0].hidden, GapSide::kLeft);
  EXPECT_DOUBLE_EQ(gaps[0].direction, std::atan2(1.0, 2.0));
  // The line of sight past (3, 2) ends at (5, 3): above it lies a trapezoid of 2 m between sides of 3 m and 2
  // m.
  EXPECT_NEAR(AreaOf(VisibilityPolygon(corridor, viewpoint)), 11.0, 1e-12);
  EXPECT_NEAR(AreaOf(PocketOf(corridor, viewpoint, gaps[0])), 5.0, 1e-12);
}

TEST(Visibility, AConvexRoomIsSeenAsAWholeAndHasNoGaps) {
  const Polygon room({{0, 0}, {4, 0.5}, {5, 3}, {2, 5}, {-1, 2}});
  test::Dice dice(1);
  for (int k = 0; k < 100; ++k) {
    const Vector2d viewpoint = test::RandomPointIn(dice, room);
    EXPECT_EQ(VisibilityPolygon(room, viewpoint).size(), 5U);
    EXPECT_NEAR(AreaOf(VisibilityPolygon(room, viewpoint)), room.Area(), 1e-12);
    EXPECT_THAT(SenseGaps(room, viewpoint), testing::IsEmpty());
  }
}

TEST(Visibility, GapsComeCounterclockwiseWithTheSideThatTheyHide) {
  const std::vector<Gap> gaps = SenseGaps(test::TwoTeeth(), {1.0, 1.0});
  EXPECT_THAT(VerticesOf(gaps), testing::ElementsAre(2, 7));
  EXPECT_EQ(gaps[0].hidden, GapSide::kRight);
  EXPECT_EQ(gaps[1].hidden, GapSide::kLeft);
}

TEST(Visibility, WhatIsSeenReachesAsFarAsRaysInAllDirections) {
  ForEachRandomViewpoint([](const Polygon& polygon, const Vector2d& viewpoint) {
    const std::vector<Vector2d> seen = VisibilityPolygon(polygon, viewpoint);
    for (int k = 0; k < 360; ++k) {
      const double direction = 0.001 + 2.0 * std::numbers::pi * k / 360.0;
      const double range = RangeWithin(polygon.vertices(), viewpoint, direction);
      EXPECT_NEAR(RangeWithin(seen, viewpoint, direction), range, 1e-9);
    }
  });
}

TEST(Visibility, GapsAreTheVerticesAtWhichTheRangeJumps) {
  ForEachRandomViewpoint([](const Polygon& polygon, const Vector2d& viewpoint) {
    std::vector<std::size_t> jumps;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vector2d to = polygon[k] - viewpoint;
      const double direction = std::atan2(to.y(), to.x());
      const double right = RangeWithin(polygon.vertices(), viewpoint, direction - 1e-9);
      const double left = RangeWithin(polygon.vertices(), viewpoint, direction + 1e-9);
      // A vertex that is itself hidden lies behind one wall, whose range is the same to both sides.
      if (std::abs(left - right) > 1e-4) jumps.push_back(k);
    }
    EXPECT_THAT(VerticesOf(SenseGaps(polygon, viewpoint)), testing::UnorderedElementsAreArray(jumps));
  });
}

TEST(Visibility, WhatIsSeenAndThePocketsOfAllGapsMakeUpThePolygon) {
  ForEachRandomViewpoint([](const Polygon& polygon, const Vector2d& viewpoint) {
    double area = AreaOf(VisibilityPolygon(polygon, viewpoint));
    for (const Gap& gap : SenseGaps(polygon, viewpoint)) {
      const double pocket = AreaOf(PocketOf(polygon, viewpoint, gap));
      EXPECT_GT(pocket, 0.0);
      area += pocket;
    }
    EXPECT_NEAR(area, polygon.Area(), 1e-9);
  });
}

TEST(Visibility, APointIsSeenFromASegmentWhereOneOfManyPlacesOnItSeesThePoint) {
  int seen_points = 0;
  ForEachRandomViewpoint([&](const Polygon& polygon, const Vector2d& from) {
    test::Dice dice(7);
    const Vector2d other = test::RandomPointIn(dice, polygon);
    if (!polygon.Sees(from, other)) return;
    for (int k = 0; k < 20; ++k) {
      const Vector2d point = test::RandomPointIn(dice, polygon);
      bool seen = false;
      for (int n = 0; n <= 1000; ++n) seen = seen || polygon.Sees(point, from + n / 1000.0 * (other - from));
      EXPECT_EQ(IsSeenFromSegment(polygon, from, other, point), seen);
      seen_points += seen ? 1 : 0;
    }
  });
  EXPECT_GT(seen_points, 100);
}

}  // namespace
}  // namespace thalweg::explorer
