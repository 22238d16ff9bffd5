#include "services/gateway/core/block_feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <tuple>

namespace thalweg::gateway {
namespace {

using Octets = std::array<std::uint8_t, BlockStates::kBytes>;
using Position = std::tuple<int, int, int>;

BlockStates Filled(int x, int y, int z, std::uint8_t octet) {
  BlockStates states{{x, y, z}, {}};
  states.octets.fill(octet);
  return states;
}

/// A client's copy, read from the bytes by hand.
class BlockCopy {
 public:
  /// @return Number of blocks in the message; -1 = there was none.
  int Read(const BlockFeed& feed) {
    const std::optional<Feed::Message> message = feed.Next(cursor_);
    if (!message) return -1;
    const std::vector<std::uint8_t>& bytes = *message->bytes;
    const auto read = [&bytes](std::size_t at, auto& value) {
      std::memcpy(&value, &bytes[4 + at], sizeof(value));
    };
    EXPECT_EQ(bytes[1], 1);  // CDR, little endian
    read(0, voxel_size);
    if (bytes[4 + 8] == 1) blocks.clear();
    std::uint32_t coordinates = 0;
    read(12, coordinates);
    const std::size_t octets_at = (16 + 2 * coordinates + 3) / 4 * 4;
    std::uint32_t octets = 0;
    read(octets_at, octets);
    EXPECT_EQ(octets, coordinates / 3 * BlockStates::kBytes);
    EXPECT_EQ(bytes.size(), 4 + octets_at + 4 + octets);
    for (std::size_t n = 0; n < coordinates / 3; ++n) {
      std::array<std::int16_t, 3> position;
      read(16 + 6 * n, position);
      read(octets_at + 4 + BlockStates::kBytes * n, blocks[{position[0], position[1], position[2]}]);
    }
    return static_cast<int>(coordinates / 3);
  }
  void ReadAll(const BlockFeed& feed) {
    while (Read(feed) >= 0) continue;
  }

  double voxel_size = 0.0;
  std::map<Position, Octets> blocks;

 private:
  std::uint64_t cursor_ = 0;
};

TEST(BlockStates, HoldTwoBitsForEachVoxel) {
  OccupancyGrid grid(0.1);
  grid.Set({0, 0, 0}, 1.0F);
  grid.Set({1, 0, 0}, -1.0F);
  grid.Set({7, 7, 7}, 0.0F);
  grid.Set({0, 1, 0}, -0.1F);
  const BlockStates states = StatesOf({0, 0, 0}, *grid.FindBlock({0, 0, 0}));
  EXPECT_EQ(states.octets[0], 2 | 1 << 2);
  EXPECT_EQ(states.octets[2], 1);  // voxel 8
  EXPECT_EQ(states.octets[127], 2 << 6);
  EXPECT_EQ(std::count(states.octets.begin(), states.octets.end(), 0), 125);
}

TEST(BlockFeed, HasNothingBeforeTheFirstMap) {
  EXPECT_EQ(BlockCopy().Read(BlockFeed()), -1);
}

TEST(BlockFeed, SendsTheWholeMapAndThenOnlyWhatChanged) {
  BlockFeed feed;
  feed.Update(Time(), 0.2, false, {Filled(0, 0, 0, 1), Filled(-3, 4, 5, 2)});
  BlockCopy copy;
  EXPECT_EQ(copy.Read(feed), 2);
  EXPECT_EQ(copy.Read(feed), -1);
  EXPECT_EQ(copy.voxel_size, 0.2);
  EXPECT_EQ(copy.blocks.at({-3, 4, 5}), Filled(0, 0, 0, 2).octets);
  feed.Update(Time(), 0.2, false, {Filled(0, 0, 0, 1), Filled(-3, 4, 5, 3)});  // the first is unchanged
  EXPECT_EQ(copy.Read(feed), 1);
  EXPECT_EQ(copy.blocks.at({-3, 4, 5}), Filled(0, 0, 0, 3).octets);
}

TEST(BlockFeed, AnotherMapReplacesTheCopyEvenIfItIsEmpty) {
  BlockFeed feed;
  feed.Update(Time(), 0.2, false, {Filled(0, 0, 0, 1)});
  BlockCopy copy;
  copy.ReadAll(feed);
  feed.Update(Time(), 0.2, true, {});
  EXPECT_EQ(copy.Read(feed), 0);
  EXPECT_TRUE(copy.blocks.empty());
  EXPECT_EQ(copy.Read(feed), -1);
}

TEST(BlockFeed, CopiesOfFastAndSlowClientsEndEqualToTheMap) {
  std::mt19937 random(3);
  const auto draw = [&random](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  BlockFeed feed;
  std::map<Position, Octets> map;
  BlockCopy fast;
  BlockCopy slow;
  for (int round = 0; round < 200; ++round) {
    const bool replaced = draw(50) == 0;
    if (replaced) map.clear();
    std::vector<BlockStates> changed;
    for (int n = 0; n < 40; ++n) {
      changed.push_back(Filled(draw(15), draw(15), draw(15), static_cast<std::uint8_t>(draw(256))));
      const VoxelIndex& b = changed.back().block;
      map[{b.x, b.y, b.z}] = changed.back().octets;
    }
    feed.Update(Time(), 0.1, replaced, changed);
    fast.ReadAll(feed);
    ASSERT_EQ(fast.blocks, map);
    if (draw(7) == 0) slow.Read(feed);
  }
  slow.ReadAll(feed);
  EXPECT_EQ(slow.blocks, map);
}

TEST(BlockFeed, ALargeMapIsSplitIntoMessagesOfLimitedSize) {
  BlockFeed feed;
  std::vector<BlockStates> blocks;
  for (int x = 0; x < 2500; ++x) blocks.push_back(Filled(x, 0, 0, 1));
  feed.Update(Time(), 0.1, true, blocks);
  BlockCopy copy;
  EXPECT_EQ(copy.Read(feed), 1024);
  EXPECT_EQ(copy.Read(feed), 1024);
  EXPECT_EQ(copy.Read(feed), 452);
  EXPECT_EQ(copy.blocks.size(), 2500U);
}

TEST(BlockFeed, KnownVolumeFollowsEveryChange) {
  BlockFeed feed;
  feed.Update(Time(), 0.5, true, {Filled(0, 0, 0, 0b00000001), Filled(1, 0, 0, 0b10011001)});
  EXPECT_DOUBLE_EQ(feed.known_volume(), (128 + 4 * 128) * 0.125);
  feed.Update(Time(), 0.5, false, {Filled(1, 0, 0, 0b00100000)});
  EXPECT_DOUBLE_EQ(feed.known_volume(), 2 * 128 * 0.125);
  feed.Update(Time(), 0.5, true, {});
  EXPECT_EQ(feed.known_volume(), 0.0);
}

}  // namespace
}  // namespace thalweg::gateway
