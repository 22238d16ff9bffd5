#include "services/link/core/map_feed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "common/scenario/models.h"
#include "common/scenario/scenario.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/simulator/tools/flight.h"

namespace thalweg::link {
namespace {

/// The copy on the other side.
struct Copy {
  OccupancyGrid grid;
  std::size_t scans = 0;
  std::size_t bytes = 0;

  void Take(const MapChange& change) {
    const Buffer wire = Encode(change);
    bytes += wire.size();
    const auto decoded = DecodeMapChange(wire);
    ASSERT_TRUE(decoded) << decoded.error();
    EXPECT_EQ(decoded->stamp, change.stamp);
    if (decoded->reset) grid.Clear();
    for (const VoxelChange& voxel : decoded->voxels) grid.Set(voxel.voxel, voxel.log_odds);
    scans += decoded->scans.size();
  }
};

VoxelChange RandomChange(std::mt19937& random) {
  const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 60) - 30; };
  const VoxelIndex voxel{coordinate(), coordinate(), coordinate()};
  const float values[] = {0.85F, -0.4F, 3.5F, -2.0F, OccupancyGrid::kUnknown};
  return {voxel, values[random() % 5] + 0.01F * static_cast<float>(random() % 3)};
}

TEST(MapFeed, TheCopyEqualsTheMapWheneverNothingWaits) {
  std::mt19937 random(1);
  OccupancyGrid grid(0.1);
  MapFeed feed(0.1);
  Copy copy{OccupancyGrid(0.1)};
  for (int round = 0; round < 30; ++round) {
    for (int update = 0; update < 5; ++update) {
      std::vector<VoxelChange> changes;
      for (int k = 0; k < 300; ++k) changes.push_back(RandomChange(random));
      for (const VoxelChange& change : changes) grid.Set(change.voxel, change.log_odds);
      feed.Note(Time{std::chrono::seconds(round)}, changes, {});
      if (const auto change = feed.Next(grid)) copy.Take(*change);
    }
    while (const auto change = feed.Next(grid)) copy.Take(*change);
    EXPECT_EQ(feed.waiting(), 0U);
    ASSERT_TRUE(copy.grid.SameAs(grid)) << round;
  }
}

TEST(MapFeed, ABlockThatChangesOftenWaitsOnce) {
  OccupancyGrid grid(0.1);
  MapFeed feed(0.1);
  Copy copy{OccupancyGrid(0.1)};
  for (int k = 0; k < 1000; ++k) {
    const VoxelChange change{{k % 8, 0, 0}, 0.001F * static_cast<float>(k)};
    grid.Set(change.voxel, change.log_odds);
    feed.Note(Time{}, std::span(&change, 1), {});
  }
  EXPECT_EQ(feed.waiting(), 1U);
  const auto change = feed.Next(grid);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->voxels.size(), 8U);
  copy.Take(*change);
  EXPECT_TRUE(copy.grid.SameAs(grid));
  EXPECT_FALSE(feed.Next(grid));
}

TEST(MapFeed, AfterARestartAllCrossesAgain) {
  std::mt19937 random(2);
  OccupancyGrid grid(0.1);
  MapFeed feed(0.1);
  for (int k = 0; k < 5000; ++k) {
    const VoxelChange change = RandomChange(random);
    grid.Set(change.voxel, change.log_odds);
    feed.Note(Time{}, std::span(&change, 1), {});
  }
  while (feed.Next(grid)) {  // crosses to a side that dies
  }
  feed.Restart(Time{}, grid);
  Copy copy{OccupancyGrid(0.1)};
  copy.grid.Set({0, 0, 0}, 1.0F);  // from before, gone at the reset
  copy.grid.Set({1000, 0, 0}, 1.0F);
  while (const auto change = feed.Next(grid)) copy.Take(*change);
  EXPECT_TRUE(copy.grid.SameAs(grid));
}

TEST(MapFeed, ScansThatWaitTooLongAreDroppedAndCounted) {
  OccupancyGrid grid(0.1);
  MapFeed feed(0.1);
  const ScanView scan{.T_WC = MakeTransform(RotationFromYawPitch(0.5, 0.1), {1, 2, 3})};
  for (int k = 0; k < 300; ++k) feed.Note(Time{}, {}, std::span(&scan, 1));
  const auto change = feed.Next(grid);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->scans.size(), MapFeed::kMostScans);
  EXPECT_EQ(feed.dropped_scans(), 300 - MapFeed::kMostScans);
  const auto decoded = DecodeMapChange(Encode(*change));
  ASSERT_TRUE(decoded);
  EXPECT_LT((decoded->scans[0].T_WC.matrix() - scan.T_WC.matrix()).norm(), 1e-12);
}

TEST(MapFeed, TheMapOfTheKitchenCostsLessThanTwoBytesAVoxelThatHasChanged) {
  const Scenario scenario = LoadScenario("kitchen");
  const simulator::World world = simulator::LoadWorld(scenario);
  const DepthSensorModel model = DepthSensorFrom(scenario);
  simulator::DepthSensor sensor(model, 1, false);
  mapper::OccupancyMap map(
      {.voxel_size = MapFrom(scenario).voxel_size, .max_range = MapFrom(scenario).max_range});
  MapFeed feed(map.grid().voxel_size());
  Copy copy{OccupancyGrid(map.grid().voxel_size())};
  const simulator::Flight flight = simulator::FlyRounds(world, simulator::Motion::kSmooth, 12.0);
  std::size_t changed = 0;
  std::size_t updates = 0;
  const auto step = static_cast<std::size_t>(flight.rate / model.rate);
  for (std::size_t frame = 0; frame < flight.T_WCs.size(); frame += step, ++updates) {
    const PointCloud cloud = sensor.Capture(world, flight.T_WCs[frame]);
    const auto changes = map.Integrate(cloud, flight.T_WCs[frame]);
    changed += changes.size();
    const ScanView scan{.T_WC = flight.T_WCs[frame], .measured = MeasuredShares::Of(cloud)};
    feed.Note(flight.StampOf(frame), changes, std::span(&scan, 1));
    while (const auto change = feed.Next(map.grid())) copy.Take(*change);
  }
  const double per_voxel = static_cast<double>(copy.bytes) / static_cast<double>(changed);
  std::cout << updates << " updates of " << changed / updates << " voxels, " << copy.bytes / updates
            << " bytes each, " << per_voxel << " bytes a voxel\n";
  EXPECT_TRUE(copy.grid.SameAs(map.grid()));
  EXPECT_EQ(copy.scans, updates);
  EXPECT_LE(per_voxel, 2.0);
}

TEST(MapFeed, GarbledChangesAreRefusedOrSound) {
  std::mt19937 random(3);
  OccupancyGrid grid(0.1);
  MapFeed feed(0.1);
  const ScanView scan{.T_WC = RigidTransform::Identity(), .measured = MeasuredShares{}};
  std::vector<VoxelChange> changes;
  for (int k = 0; k < 50; ++k) changes.push_back(RandomChange(random));
  for (const VoxelChange& change : changes) grid.Set(change.voxel, change.log_odds);
  feed.Note(Time{}, changes, std::span(&scan, 1));
  const auto good = Unpack(Encode(*feed.Next(grid)));
  ASSERT_TRUE(good);
  int refused = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    Buffer bad = *good;
    for (int n = 0; n < 2; ++n) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) bad.resize(random() % bad.size());
    const auto change = DecodeMapChange(Pack(bad));
    if (!change) {
      ++refused;
      continue;
    }
    for (const VoxelChange& voxel : change->voxels) EXPECT_FALSE(std::isinf(voxel.log_odds));
  }
  EXPECT_GT(refused, 5000);
}

}  // namespace
}  // namespace thalweg::link
