#include "services/gateway/core/inbox.h"

#include <gtest/gtest.h>

namespace thalweg::gateway {
namespace {

Inbox::Item Item(std::size_t topic, std::size_t size, std::int64_t number) {
  return {topic, Time(Duration(number)), std::make_shared<const std::vector<std::uint8_t>>(size), 0};
}

BlockStates FilledBlock(int x, std::uint8_t octet) {
  BlockStates block;
  block.block = {x, 0, 0};
  block.octets.fill(octet);
  return block;
}

TEST(Inbox, TheServerIsToldOnceAndTakesAllInOrder) {
  Inbox inbox;
  EXPECT_TRUE(inbox.Put(Item(3, 1, 1)));
  EXPECT_FALSE(inbox.Put(Item(2, 1, 2)));
  EXPECT_FALSE(inbox.Put(Inbox::MapChange{}));
  const Inbox::Content content = inbox.TakeAll();
  ASSERT_EQ(content.items.size(), 2U);
  EXPECT_EQ(content.items[0].topic, 3U);
  EXPECT_EQ(content.items[1].topic, 2U);
  EXPECT_TRUE(content.map);
  EXPECT_TRUE(inbox.TakeAll().items.empty());
  EXPECT_TRUE(inbox.Put(Item(3, 1, 3))) << "it was empty again";
}

TEST(Inbox, AServerThatDoesNotLookCostsBoundedMemoryAndTheNewestOfEachTopicRemain) {
  Inbox inbox;
  constexpr std::size_t kImage = 3 << 20;
  for (std::int64_t n = 0; n < 1000; ++n) {
    inbox.Put(Item(0, 10, n));
    inbox.Put(Item(1, kImage, n));
    inbox.Put(Item(2, Inbox::kMostBytes + 1, n));
  }
  std::map<std::size_t, std::vector<std::int64_t>> numbers;
  for (const Inbox::Item& item : inbox.TakeAll().items) {
    numbers[item.topic].push_back(item.stamp.time_since_epoch().count());
  }
  EXPECT_EQ(numbers[0].size(), Inbox::kMostMessages);
  EXPECT_EQ(numbers[0].back(), 999);
  EXPECT_EQ(numbers[1], (std::vector<std::int64_t>{998, 999})) << "of 3 MiB each, within 8";
  EXPECT_EQ(numbers[2], std::vector<std::int64_t>{999}) << "the newest waits, however large";
  EXPECT_EQ(inbox.TakeReplaced(), 3000U - Inbox::kMostMessages - 2 - 1);
  EXPECT_EQ(inbox.TakeReplaced(), 0U);
}

TEST(Inbox, OfTheMapEachBlockWaitsOnceAsItIsNow) {
  Inbox inbox;
  for (int round = 0; round < 100; ++round) {
    inbox.Put(Inbox::MapChange{Time(), 0.1, round == 0, {FilledBlock(0, 1), FilledBlock(round % 4, 2)}});
  }
  const Inbox::Content content = inbox.TakeAll();
  ASSERT_TRUE(content.map);
  EXPECT_TRUE(content.map->replaced) << "as the first of them says";
  EXPECT_EQ(content.map->blocks.size(), 4U);
}

TEST(Inbox, AnotherMapForgetsWhatWaited) {
  Inbox inbox;
  inbox.Put(Inbox::MapChange{Time(), 0.1, false, {FilledBlock(0, 1)}});
  inbox.Put(Inbox::MapChange{Time(), 0.2, true, {FilledBlock(7, 1)}});
  const Inbox::Content content = inbox.TakeAll();
  ASSERT_EQ(content.map->blocks.size(), 1U);
  EXPECT_EQ(content.map->blocks[0].block.x, 7);
  EXPECT_EQ(content.map->voxel_size, 0.2);
}

}  // namespace
}  // namespace thalweg::gateway
