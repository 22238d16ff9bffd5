// How the map treats points with a stated depth error.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "services/mapper/core/occupancy_map.h"
#include "tests/services/mapper/core/small_clouds.h"
#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::SinglePoint;

constexpr float kClearSigmas = 3.25F;  // three of the estimate and a quarter of one measurement

RigidTransform AlongX() {
  return MakeTransform(RotationFromYawPitch(0.0, 0.0) * BodyFromOptical(), {0.03, 0.04, 0.05});
}

OccupancyMap::Options WithError(double sigma, int window_px) {
  OccupancyMap::Options options;
  options.depth_error = {.sigma = sigma, .window_px = window_px};
  return options;
}

TEST(OccupancyMap, APointKnownWellIsAHit) {
  OccupancyMap map(WithError(0.001, 1));        // 4 mm at 2 m
  map.Integrate(SinglePoint(2.02F), AlongX());  // x = 2.05: the center of its voxel
  EXPECT_EQ(map.grid().State(map.grid().IndexOf({2.05, 0.04, 0.05})), VoxelState::kOccupied);
  EXPECT_EQ(map.grid().State(map.grid().IndexOf({1.95, 0.04, 0.05})), VoxelState::kFree);
}

TEST(OccupancyMap, APointOnTheFaceOfItsVoxelIsNoHit) {
  OccupancyMap map(WithError(0.001, 1));
  map.Integrate(SinglePoint(1.971F), AlongX());  // x = 2.001
  EXPECT_TRUE(map.hits().empty());
  EXPECT_EQ(map.grid().State(map.grid().IndexOf({2.05, 0.04, 0.05})), VoxelState::kUnknown);
  EXPECT_EQ(map.grid().State(map.grid().IndexOf({1.85, 0.04, 0.05})), VoxelState::kFree);
}

TEST(OccupancyMap, AnUnsurePointOnlyClearsWhatSurelyLiesBeforeIt) {
  constexpr float kSigma = 0.05F;  // 0.8 m at 4 m
  OccupancyMap map(WithError(static_cast<double>(kSigma), 1));
  map.Integrate(SinglePoint(4.0F), AlongX());
  EXPECT_TRUE(map.hits().empty());
  const double clear = 1.0 / (0.25 + static_cast<double>(kClearSigmas * kSigma));
  for (double x = 0.05; x < 4.5; x += 0.1) {
    const VoxelState state = map.grid().State(map.grid().IndexOf({x, 0.04, 0.05}));
    EXPECT_EQ(state, x + 0.05 < clear + 0.03 ? VoxelState::kFree : VoxelState::kUnknown) << x;
  }
}

TEST(OccupancyMap, AnUnsurePointClearsNoVoxelThatIsOccupied) {
  OccupancyMap map(WithError(0.01, 1));  // 1 cm at 1 m, 16 cm at 4 m
  map.Integrate(SinglePoint(1.02F), AlongX());
  const VoxelIndex hit = map.grid().IndexOf({1.05, 0.04, 0.05});
  const float log_odds = map.grid().LogOdds(hit);
  ASSERT_GT(log_odds, 0.0F);
  for (int scan = 0; scan < 10; ++scan) map.Integrate(SinglePoint(4.0F), AlongX());
  EXPECT_EQ(map.grid().LogOdds(hit), log_odds);
  for (int scan = 0; scan < 10; ++scan) map.Integrate(SinglePoint(1.32F), AlongX());
  EXPECT_EQ(map.grid().State(hit), VoxelState::kFree) << "one that is sure does";
}

TEST(OccupancyMap, UnsurePointsCallNothingSurelyFreeHoweverOftenTheyClearIt) {
  OccupancyMap map(WithError(0.01, 1));
  const VoxelIndex before = map.grid().IndexOf({1.05, 0.04, 0.05});
  for (int scan = 0; scan < 20; ++scan) map.Integrate(SinglePoint(4.0F), AlongX());
  EXPECT_EQ(map.grid().LogOdds(before), OccupancyGrid::kWeaklyFree);
  map.Integrate(SinglePoint(1.32F), AlongX());
  EXPECT_LT(map.grid().LogOdds(before), OccupancyGrid::kWeaklyFree) << "one that is sure does";

  OccupancyMap other(WithError(0.01, 1));
  for (int scan = 0; scan < 20; ++scan) other.Integrate(SinglePoint(4.0F), AlongX());
  other.Integrate(SinglePoint(1.02F), AlongX());
  EXPECT_EQ(other.grid().State(before), VoxelState::kOccupied) << "so one sure hit is enough";
}

/// Share of correctly classified voxels among the known ones, for a furnished room seen with noise.
/// Reference: the map without noise.
double ShareRight(const OccupancyMap::Options& options, double sigma) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const auto camera = PinholeCamera::FromFieldOfView(100, 100, 1.309);
  OccupancyMap noisy(options);
  OccupancyMap exact({});
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, sigma);
  for (int view = 0; view < 60; ++view) {
    const RigidTransform T_WC = room.RandomPose(random);
    PointCloud cloud = room.Render(camera, T_WC);
    exact.Integrate(cloud, T_WC);
    for (Eigen::Vector3f& p_C : cloud.points_C) {
      const double inverse = 1.0 / static_cast<double>(p_C.z()) + noise(random);
      p_C = inverse > 0.0 ? Eigen::Vector3f(p_C / p_C.z() / static_cast<float>(inverse))
                          : Eigen::Vector3f::Constant(std::nanf(""));
    }
    noisy.Integrate(cloud, T_WC);
  }
  std::size_t known = 0, right = 0;
  noisy.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    ++known;
    right += OccupancyGrid::StateOf(log_odds) == exact.grid().State(i) ? 1 : 0;
  });
  EXPECT_GT(known, 60'000U);
  return static_cast<double>(right) / static_cast<double>(known);
}

TEST(OccupancyMap, ANoisyMapIsThatWithoutNoise) {
  constexpr double kSigma = 0.025;  // 1 px of 333 px * 0.12 m
  EXPECT_GT(ShareRight(WithError(kSigma, 11), kSigma), 0.975);
  EXPECT_LT(ShareRight({}, kSigma), 0.9) << "then noise as this would be no test";
}

}  // namespace
}  // namespace thalweg::mapper
