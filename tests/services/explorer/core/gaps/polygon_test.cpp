#include "services/explorer/core/gaps/polygon.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/services/explorer/support/gap_rooms.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;

TEST(Polygon, AreaPerimeterAndReflexVerticesAreThoseOfABentCorridor) {
  const Polygon corridor = test::BentCorridor();
  EXPECT_DOUBLE_EQ(corridor.Area(), 16.0);
  EXPECT_DOUBLE_EQ(corridor.Perimeter(), 20.0);
  for (std::size_t k = 0; k < corridor.size(); ++k) EXPECT_EQ(corridor.IsReflex(k), k == 4) << k;
  EXPECT_DOUBLE_EQ(corridor.RoomAround(4), 2.0);
}

TEST(Polygon, OnlyWhatLiesWithinItsWallsIsInside) {
  const Polygon corridor = test::BentCorridor();
  EXPECT_TRUE(corridor.Contains({1.0, 1.0}));
  EXPECT_TRUE(corridor.Contains({4.0, 4.0}));
  EXPECT_FALSE(corridor.Contains({1.0, 3.0}));
  EXPECT_FALSE(corridor.Contains({6.0, 1.0}));
  EXPECT_FALSE(corridor.Contains({-1.0, 1.0}));
}

TEST(Polygon, AWallBetweenTwoPointsBlocksTheView) {
  const Polygon corridor = test::BentCorridor();
  EXPECT_TRUE(corridor.Sees({1.0, 1.0}, {4.0, 2.4}));
  EXPECT_FALSE(corridor.Sees({1.0, 1.0}, {4.0, 2.6}));
  EXPECT_TRUE(corridor.Sees({1.0, 1.0}, {3.0, 2.0}));
  EXPECT_FALSE(corridor.Sees({1.0, 1.0}, {3.0, 5.0}));
}

TEST(Polygon, ARayEndsAtTheFirstWall) {
  const Polygon corridor = test::BentCorridor();
  EXPECT_TRUE(corridor.FirstHit({1.0, 1.0}, {1.0, 0.0}).isApprox(Vector2d(5.0, 1.0)));
  EXPECT_TRUE(corridor.FirstHit({1.0, 1.0}, {0.0, 2.0}).isApprox(Vector2d(1.0, 2.0)));
  EXPECT_TRUE(corridor.FirstHit({3.0, 2.0}, {2.0, 1.0}).isApprox(Vector2d(5.0, 3.0)));
}

TEST(Polygon, MistakenVerticesAreRefused) {
  EXPECT_THROW(Polygon({{0, 0}, {1, 0}}), std::invalid_argument);
  EXPECT_THROW(Polygon({{0, 0}, {0, 1}, {1, 0}}), std::invalid_argument);                   // clockwise
  EXPECT_THROW(Polygon({{0, 0}, {3, 0}, {3, 3}, {1, -1}, {0, 3}}), std::invalid_argument);  // crosses itself
  EXPECT_THROW(Polygon({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}), std::invalid_argument);   // touches itself
}

TEST(Polygon, AsManyRandomPointsAreInsideAsItsAreaSays) {
  for (const test::PolygonKind kind : test::kPolygonKinds) {
    const Polygon polygon = test::RandomPolygon(kind, 3);
    test::Dice dice(5);
    int inside = 0;
    constexpr int kPoints = 100'000;
    for (int k = 0; k < kPoints; ++k) inside += polygon.Contains(dice.Point(-10.0, 20.0)) ? 1 : 0;
    const double share = polygon.Area() / (30.0 * 30.0);
    // Five standard deviations of the binomial distribution.
    EXPECT_NEAR(inside, share * kPoints, 5.0 * std::sqrt(share * (1.0 - share) * kPoints));
  }
}

}  // namespace
}  // namespace thalweg::explorer
