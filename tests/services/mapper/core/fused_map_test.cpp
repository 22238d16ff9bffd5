#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "docs/examples/own_map.h"
#include "services/mapper/core/map_engine.h"
#include "tests/services/mapper/core/small_clouds.h"
#include "tests/services/mapper/support/each_engine.h"
#include "tests/support/analytic_room.h"

// What every engine does, with OctoMap's options: what only OccupancyMap does beyond them is in
// occupancy_map_rules_test.cpp and occupancy_map_noise_test.cpp.

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::kInfinity;
using test::kNaN;
using test::LevelPose;
using test::SinglePoint;

class EachEngine : public testing::TestWithParam<MapEngine> {
 protected:
  static std::unique_ptr<FusedMap> New(
      const OccupancyMap::Options& options = OccupancyMap::Options::OfOctomap()) {
    return MakeMap(GetParam(), options);
  }
};

TEST_P(EachEngine, LogOddsAreCountsTimesStepsUntilClamped) {
  const auto map = New();
  const VoxelIndex wall = map->Snapshot().IndexOf({2.03, 0.04, 0.05});
  const VoxelIndex space = map->Snapshot().IndexOf({1.03, 0.04, 0.05});
  for (int scan = 1; scan <= 10; ++scan) {
    map->Integrate(SinglePoint(2.0F), LevelPose());
    EXPECT_NEAR(map->Snapshot().LogOdds(wall), std::min(3.5, 0.85 * scan), 1e-5);
    EXPECT_NEAR(map->Snapshot().LogOdds(space), std::max(-2.0, -0.4 * scan), 1e-5);
  }
  for (int scan = 1; scan <= 20; ++scan) {
    map->Integrate(SinglePoint(3.0F), LevelPose());  // the wall is gone
    EXPECT_NEAR(map->Snapshot().LogOdds(wall), std::max(-2.0, 3.5 - 0.4 * scan), 1e-5);
  }
}

TEST_P(EachEngine, ChangesNameEachChangedVoxelOnceAndNoOther) {
  const auto map = New();
  OccupancyGrid copy(0.1);
  std::mt19937 random(3);
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const auto camera = PinholeCamera::FromFieldOfView(60, 50, 1.3);
  for (int scan = 0; scan < 10; ++scan) {
    const RigidTransform T_WC = room.RandomPose(random);
    for (int again = 0; again < 16; ++again) {
      for (const VoxelChange& change : map->Integrate(room.Render(camera, T_WC), T_WC)) {
        EXPECT_NE(copy.LogOdds(change.voxel), change.log_odds);
        copy.Set(change.voxel, change.log_odds);
      }
      EXPECT_TRUE(copy.SameAs(map->Snapshot()));
    }
    EXPECT_TRUE(map->Integrate(room.Render(camera, T_WC), T_WC).empty()) << "all is clamped by now";
  }
}

TEST_P(EachEngine, RayBeyondMaxRangeOnlyClearsSpace) {
  const auto map = New();
  map->Integrate(SinglePoint(7.0F), LevelPose());
  EXPECT_EQ(map->Snapshot().State(map->Snapshot().IndexOf({4.9, 0.04, 0.05})), VoxelState::kFree);
  EXPECT_EQ(map->Snapshot().State(map->Snapshot().IndexOf({5.2, 0.04, 0.05})), VoxelState::kUnknown);
  map->Snapshot().ForEachKnown([](const VoxelIndex&, float log_odds) { EXPECT_LT(log_odds, 0.0F); });
}

TEST_P(EachEngine, PointsNearerThanMinRangeAreIgnored) {
  OccupancyMap::Options options = OccupancyMap::Options::OfOctomap();
  options.min_range = 0.5;
  const auto map = New(options);
  EXPECT_TRUE(map->Integrate(SinglePoint(0.49F), LevelPose()).empty());
  EXPECT_FALSE(map->Integrate(SinglePoint(0.51F), LevelPose()).empty());
}

TEST_P(EachEngine, CloudsWithoutMeasurementsChangeNothing) {
  const auto map = New();
  EXPECT_TRUE(map->Integrate(PointCloud{}, LevelPose()).empty());
  EXPECT_TRUE(map->Integrate(SinglePoint(kNaN), LevelPose()).empty());
  EXPECT_TRUE(map->Integrate(SinglePoint(kInfinity), LevelPose()).empty());
  EXPECT_TRUE(map->Integrate(SinglePoint(1e30F), LevelPose()).empty());
  const PointCloud half_nan{.width_px = 2,
                            .height_px = 1,
                            .points_C = {{kNaN, 0.0F, 1.0F}, {0.0F, 0.0F, -kInfinity}},
                            .colors = {}};
  EXPECT_TRUE(map->Integrate(half_nan, LevelPose()).empty());
  EXPECT_TRUE(map->empty());
}

TEST_P(EachEngine, PosesBeyondTheGridChangeNothing) {
  const auto map = New();
  for (const double x : {1e5, -1e5, 1e300, static_cast<double>(kNaN)}) {
    EXPECT_TRUE(map->Integrate(SinglePoint(2.0F), MakeTransform(BodyFromOptical(), {x, 0, 0})).empty());
  }
}

TEST_P(EachEngine, RefusesOptionsThatMakeNoSense) {
  using Options = OccupancyMap::Options;
  const auto text_of = [](const Options& options) -> std::string {
    try {
      New(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(text_of({.voxel_size = 0.0}), testing::HasSubstr("voxel_size"));
  EXPECT_THAT(text_of({.voxel_size = std::nan("")}), testing::HasSubstr("voxel_size"));
  EXPECT_THAT(text_of({.max_range = -1.0}), testing::HasSubstr("max_range"));
  EXPECT_THAT(text_of({.voxel_size = 0.01, .max_range = 5.0}), testing::HasSubstr("max_range"));
  EXPECT_THAT(text_of({.min_range = 6.0}), testing::HasSubstr("min_range"));
  EXPECT_THAT(text_of({.log_odds_hit = 0.0F}), testing::HasSubstr("log_odds_hit"));
  EXPECT_THAT(text_of({.log_odds_miss = 0.4F}), testing::HasSubstr("log_odds_miss"));
  EXPECT_THAT(text_of({.log_odds_min = 1.0F}), testing::HasSubstr("log_odds_min"));
  EXPECT_THAT(text_of({.log_odds_max = -1.0F}), testing::HasSubstr("log_odds_max"));
  EXPECT_THAT(text_of({.fill_max_gap = 0.0}), testing::HasSubstr("fill_max_gap"));
  EXPECT_THAT(text_of({.fill_tolerance = -1.0}), testing::HasSubstr("fill_tolerance"));
  EXPECT_EQ(text_of({}), "");
  EXPECT_THROW(MakeMap(GetParam(), Options{.voxel_size = 0.1}, OccupancyGrid(0.2)), std::invalid_argument);
}

TEST_P(EachEngine, HitsNameEachOccupiedVoxelOnceWithAPixelInIt) {
  const auto map = New({.fill = false});  // else also voxels between two pixels
  const test::AnalyticRoom room = test::AnalyticRoom::Furnished();
  std::mt19937 random(9);
  const RigidTransform T_WC = room.RandomPose(random);
  const PointCloud cloud = room.Render(PinholeCamera::FromFieldOfView(80, 60, 1.3), T_WC, 4.5);
  map->Integrate(cloud, T_WC);
  std::size_t occupied = 0;
  map->Snapshot().ForEachKnown(
      [&](const VoxelIndex&, float log_odds) { occupied += log_odds >= 0.0F ? 1 : 0; });
  EXPECT_EQ(map->hits().size(), occupied);
  EXPECT_GT(occupied, 50u);
  for (const Hit& hit : map->hits()) {
    EXPECT_EQ(map->Snapshot().State(hit.voxel), VoxelState::kOccupied);
    const Eigen::Vector3d p_W = T_WC * cloud.points_C[hit.pixel].cast<double>();
    EXPECT_LT((map->Snapshot().CenterOf(hit.voxel) - p_W).cwiseAbs().maxCoeff(), 0.0501);
  }
}

TEST_P(EachEngine, GoesOnFromAStoredMapAsIfItHadNeverStopped) {
  for (const bool exact_rays : {false, true}) {
    OccupancyMap::Options options = OccupancyMap::Options::OfOctomap();
    options.exact_rays = exact_rays;
    std::unique_ptr<FusedMap> map = New(options);
    const auto without_stop = New(options);
    std::mt19937 random(5);
    const AnalyticRoom room = AnalyticRoom::Furnished();
    for (int scan = 0; scan < 8; ++scan) {
      map = MakeMap(GetParam(), options, map->Snapshot());
      const RigidTransform T_WC = room.RandomPose(random);
      const PointCloud cloud = room.Render(PinholeCamera::FromFieldOfView(60, 45, 1.3), T_WC);
      const auto changes = map->Integrate(cloud, T_WC);
      EXPECT_EQ(changes.size(), without_stop->Integrate(cloud, T_WC).size());
      EXPECT_TRUE(map->Snapshot().SameAs(without_stop->Snapshot()));
    }
    EXPECT_FALSE(map->empty());
  }
}

TEST_P(EachEngine, TakesOverValuesBeyondItsOwnLimitsAsTheyAre) {
  OccupancyGrid stored(0.1);
  stored.Set({3, -4, 5}, 7.5F);
  stored.Set({-30000, 0, 32767}, -6.25F);
  stored.Set({3, -4, 6}, 0.0F);
  const auto map = MakeMap(GetParam(), {}, CopyOf(stored));
  EXPECT_TRUE(map->Snapshot().SameAs(stored));
}

INSTANTIATE_TEST_SUITE_P(Engines, EachEngine, test::kEngines, test::NameOfEngine);

TEST(OwnMap, KeepsTheContractOfAFusedMap) {
  OnceOccupied map{OccupancyGrid(0.1)};
  EXPECT_TRUE(map.empty());
  OccupancyGrid copy(0.1);
  std::mt19937 random(5);
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const auto camera = PinholeCamera::FromFieldOfView(50, 40, 1.3);
  for (int scan = 0; scan < 10; ++scan) {
    const RigidTransform T_WC = room.RandomPose(random);
    const PointCloud cloud = room.Render(camera, T_WC, 4.0);
    for (const VoxelChange& change : map.Integrate(cloud, T_WC)) {
      EXPECT_NE(change.log_odds, copy.LogOdds(change.voxel)) << "changes twice, or not at all";
      EXPECT_NE(copy.State(change.voxel), VoxelState::kOccupied) << "is occupied for good";
      copy.Set(change.voxel, change.log_odds);
    }
    EXPECT_TRUE(map.Snapshot().SameAs(copy));
    std::set<std::uint32_t> pixels;
    for (const Hit& hit : map.hits()) {
      EXPECT_EQ(copy.IndexOf(T_WC * cloud.points_C[hit.pixel].cast<double>()), hit.voxel);
      EXPECT_EQ(copy.State(hit.voxel), VoxelState::kOccupied);
      EXPECT_TRUE(pixels.insert(hit.pixel).second);
    }
  }
  EXPECT_FALSE(map.empty());
}

}  // namespace
}  // namespace thalweg::mapper
