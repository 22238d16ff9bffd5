#include "services/gateway/core/map_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace thalweg::gateway {
namespace {

using std::chrono_literals::operator""s;

/// A block with the given voxels occupied and all others free.
BlockStates Occupied(const VoxelIndex& block, const std::vector<int>& voxels) {
  OccupancyGrid::Block log_odds;
  log_odds.fill(-1.0F);
  for (const int k : voxels) log_odds[static_cast<std::size_t>(k)] = 1.0F;
  return StatesOf(block, log_odds);
}

TEST(MapPoints, AreTheCentersOfTheOccupiedVoxels) {
  BlockFeed map;
  // Voxel 7 + 8 * (1 + 8 * 2) of block (-1, 0, 1) is (-8 + 7, 1, 8 + 2).
  map.Update(Time(), 0.5, true, {Occupied({-1, 0, 1}, {7 + 8 * (1 + 8 * 2)}), Occupied({3, 3, 3}, {})});
  const std::vector<std::uint8_t> bytes = MapPoints(map, "map");
  // The data lie before the last octet, is_dense.
  ASSERT_GT(bytes.size(), 17U);
  std::array<float, 3> point = {};
  std::memcpy(point.data(), bytes.data() + bytes.size() - 17, sizeof(point));
  EXPECT_EQ(point, (std::array<float, 3>{-0.25F, 0.75F, 5.25F}));
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + bytes.size() - 21, sizeof(count));
  EXPECT_EQ(count, 16U);
}

TEST(MapPoints, AreInTheFrameOfTheMapAsItIsCalledOnTheWire) {
  const std::vector<std::uint8_t> bytes = MapPoints(BlockFeed(), "scout/map");
  // After the encapsulation header and the stamp, of 4 and 8 octets, come the length of the text and the
  // text.
  EXPECT_EQ(std::string(bytes.begin() + 16, bytes.begin() + 25), "scout/map");
}

TEST(MapPoints, AreMadeAtMostOnceASecondAndOnlyOfAMapThatHasChanged) {
  BlockFeed map;
  MapPointsFeed feed("map");
  std::uint64_t cursor = 0;
  feed.Refresh(map, 1s);
  EXPECT_FALSE(feed.Next(cursor));
  map.Update(Time(), 0.1, true, {Occupied({0, 0, 0}, {0})});
  feed.Refresh(map, 2s);
  const auto first = feed.Next(cursor);
  ASSERT_TRUE(first);
  EXPECT_FALSE(feed.Next(cursor));
  feed.Refresh(map, 5s);
  EXPECT_FALSE(feed.Next(cursor)) << "nothing has changed";
  map.Update(Time(), 0.1, false, {Occupied({1, 0, 0}, {0, 1})});
  feed.Refresh(map, Duration(2s) + std::chrono::milliseconds(900));
  EXPECT_FALSE(feed.Next(cursor)) << "the last is not a second old";
  feed.Refresh(map, 3s);
  const auto second = feed.Next(cursor);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->bytes->size(), first->bytes->size() + 2 * 16);
}

}  // namespace
}  // namespace thalweg::gateway
