#include "services/explorer/core/gaps/critical_rays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/services/explorer/support/gap_rooms.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;
using RayKind = CriticalRay::Kind;

std::vector<CriticalRay> RaysBetween(const Polygon& polygon, std::size_t near, std::size_t far) {
  std::vector<CriticalRay> found;
  for (const CriticalRay& ray : CriticalRays(polygon)) {
    if (ray.near == near && ray.far == far) found.push_back(ray);
  }
  return found;
}

bool Crosses(const CriticalRay& ray, const Vector2d& a, const Vector2d& b) {
  return (ray.Depth(a) > 0.0) != (ray.Depth(b) > 0.0) &&
         (Cross(b - a, ray.start - a) > 0.0) != (Cross(b - a, ray.end - a) > 0.0);
}

std::vector<std::size_t> SortedGaps(const Polygon& polygon, const Vector2d& viewpoint) {
  std::vector<std::size_t> vertices;
  for (const Gap& gap : SenseGaps(polygon, viewpoint)) vertices.push_back(gap.vertex);
  std::ranges::sort(vertices);
  return vertices;
}

TEST(CriticalRays, ACornerHasTheTwoExtensionsOfItsWalls) {
  const std::vector<CriticalRay> rays = CriticalRays(test::BentCorridor());
  ASSERT_EQ(rays.size(), 2U);
  for (const CriticalRay& ray : rays) {
    EXPECT_EQ(ray.kind, RayKind::kInflection);
    EXPECT_EQ(ray.near, 4U);
    EXPECT_TRUE(ray.start.isApprox(Vector2d(3, 2)));
  }
  // From the left room the upper one is hidden, by the upright wall; from the upper room the left one.
  EXPECT_EQ(rays[0].far, 3U);
  EXPECT_TRUE(rays[0].end.isApprox(Vector2d(3, 0)));
  EXPECT_GT(rays[0].Depth({1, 1}), 0.0);
  EXPECT_LT(rays[0].Depth({4, 1}), 0.0);
  EXPECT_EQ(rays[1].far, 5U);
  EXPECT_TRUE(rays[1].end.isApprox(Vector2d(5, 2)));
  EXPECT_GT(rays[1].Depth({4, 4}), 0.0);
  EXPECT_LT(rays[1].Depth({4, 1}), 0.0);
}

TEST(CriticalRays, AConvexRoomHasNone) {
  EXPECT_THAT(CriticalRays(Polygon({{0, 0}, {4, 0.5}, {5, 3}, {2, 5}, {-1, 2}})), testing::IsEmpty());
}

TEST(CriticalRays, TwoCornersOnTheSameSideHaveABitangent) {
  const Polygon corridor = test::TwoDeadEnds();
  const std::vector<CriticalRay> left = RaysBetween(corridor, 10, 6);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].kind, RayKind::kBitangent);
  // y = 1.9 + (x - 4) / 8, at the left wall.
  EXPECT_TRUE(left[0].end.isApprox(Vector2d(0, 1.4)));
  EXPECT_GT(left[0].Depth({1, 1.6}), 0.0);
  EXPECT_LT(left[0].Depth({1, 1.5}), 0.0);
  const std::vector<CriticalRay> slide = RaysBetween(corridor, 7, 6);
  ASSERT_EQ(slide.size(), 1U);
  EXPECT_EQ(slide[0].kind, RayKind::kSlide);
}

TEST(CriticalRays, TwoCornersOnOppositeSidesHaveABitangent) {
  const std::vector<CriticalRay> rays = RaysBetween(test::TwoTeeth(), 7, 2);
  ASSERT_EQ(rays.size(), 1U);
  EXPECT_EQ(rays[0].kind, RayKind::kBitangent);
  EXPECT_TRUE(rays[0].end.isApprox(Vector2d(0, 22.0 / 15.0)));
  EXPECT_GT(rays[0].Depth({1, 1.5}), 0.0);
  EXPECT_LT(rays[0].Depth({1, 1.3}), 0.0);
}

TEST(CriticalRays, ThreeCornersInALineAreRefused) {
  // Two alcoves whose near corners are exactly as high as the ceiling between them.
  EXPECT_THROW(CriticalRays(Polygon({{0, 0},
                                     {12, 0},
                                     {12, 2},
                                     {10, 2},
                                     {10, 5},
                                     {8, 5},
                                     {8, 2},
                                     {6, 2},
                                     {6, 5},
                                     {4, 5},
                                     {4, 2},
                                     {0, 2}})),
               std::invalid_argument);
}

TEST(CriticalRays, TheGapsInSightChangeAcrossARayAndNowhereElse) {
  int without = 0;
  int across_one = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const test::PolygonKind kind : test::kPolygonKinds) {
      const Polygon polygon = test::RandomPolygon(kind, seed);
      const std::vector<CriticalRay> rays = CriticalRays(polygon);
      test::Dice dice(seed);
      for (int k = 0; k < 200; ++k) {
        const Vector2d a = test::RandomPointIn(dice, polygon);
        const Vector2d b = a + dice.Point(-0.3, 0.3);
        if (!polygon.Contains(b) || !polygon.Sees(a, b)) continue;
        const auto crossed = std::ranges::count_if(rays, [&](const auto& ray) { return Crosses(ray, a, b); });
        if (crossed > 1) continue;
        ++(crossed == 0 ? without : across_one);
        EXPECT_EQ(SortedGaps(polygon, a) != SortedGaps(polygon, b), crossed == 1);
      }
    }
  }
  EXPECT_GT(without, 1000);
  EXPECT_GT(across_one, 1000);
}

}  // namespace
}  // namespace thalweg::explorer
