#include "services/recorder/adapter/update_follower.h"

#include <gtest/gtest.h>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "common/dds/topic_table.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using MapUpdate = thalweg_msgs::msg::MapUpdate;
using SurfaceUpdate = thalweg_msgs::msg::SurfaceUpdate;

TEST(RenamedSession, DiffersForSessionsAndTokensAndIsNeverZero) {
  EXPECT_EQ(RenamedSession(7, 0), 7U);
  EXPECT_NE(RenamedSession(7, 1), RenamedSession(7, 2));
  EXPECT_NE(RenamedSession(7, 1), RenamedSession(8, 1));
  EXPECT_NE(RenamedSession(7, 7), 0U);
}

/// An update of voxel (number, 0, 0) with log-odds 1.
std::vector<std::uint8_t> MapSample(dds::MapLog& log, int number) {
  const VoxelChange change{{number, 0, 0}, 1.0F};
  log.Add(Time{std::chrono::seconds(number)}, {&change, 1});
  return dds::Encode<topics::MapUpdates>(log.TakeUpdate());
}

TEST(UpdateFollower, AFullCopyOfTheMapIsWhatAReaderHasToWhichLaterUpdatesFit) {
  const auto follower = MakeUpdateFollower(topics::MapUpdates::kName);
  dds::MapLog log(5, 0.1);
  EXPECT_FALSE(follower->FullCopy());
  follower->Follow(dds::Encode<topics::MapUpdates>(log.FullCopy(OccupancyGrid(0.1))), 9);
  for (int k = 1; k <= 3; ++k) follower->Follow(MapSample(log, k), 9);
  dds::MapReplica replica;
  const auto copy = follower->FullCopy();
  ASSERT_TRUE(copy);
  ASSERT_TRUE(replica.Apply(*dds::Decode<topics::MapUpdates>(*copy)));
  EXPECT_EQ(replica.session(), RenamedSession(5, 9));
  EXPECT_EQ(replica.number(), 3U);
  for (int k = 1; k <= 4; ++k) {
    EXPECT_EQ(std::isnan(replica.grid().LogOdds({k, 0, 0})), k == 4) << k;
  }
  const auto applied =
      replica.Apply(*dds::Decode<topics::MapUpdates>(follower->Renamed(MapSample(log, 4), 9)));
  ASSERT_TRUE(applied && *applied);
  EXPECT_EQ(replica.grid().LogOdds({4, 0, 0}), 1.0F);
  EXPECT_FALSE(replica.missing());

  const auto nothing = follower->Nothing(*copy, 77);
  ASSERT_TRUE(nothing);
  ASSERT_TRUE(replica.Apply(*dds::Decode<topics::MapUpdates>(*nothing)));
  EXPECT_EQ(replica.session(), 77U);
  EXPECT_EQ(replica.grid().block_count(), 0U);
}

TEST(UpdateFollower, WhatDoesNotDecodeIsLeftOutAndNotRenamed) {
  for (const char* const topic : {topics::MapUpdates::kName, topics::SurfaceUpdates::kName}) {
    const auto follower = MakeUpdateFollower(topic);
    const std::vector<std::uint8_t> nonsense = {0, 1, 0, 0, 255, 255, 255, 255, 255};
    follower->Follow(nonsense);
    EXPECT_FALSE(follower->FullCopy());
    EXPECT_FALSE(follower->Nothing(nonsense, 1));
    EXPECT_EQ(follower->Renamed(nonsense, 1), nonsense);
  }
  EXPECT_EQ(MakeUpdateFollower(topics::Odometry::kName), nullptr);
}

thalweg_msgs::msg::SurfaceBlock Block(int x, int vertices) {
  thalweg_msgs::msg::SurfaceBlock block;
  block.x(x);
  block.points_m(std::vector<float>(static_cast<std::size_t>(3 * vertices), 0.5F));
  return block;
}

std::vector<std::uint8_t> SurfaceSample(std::uint64_t session, std::uint64_t number, bool full,
                                        const std::vector<thalweg_msgs::msg::SurfaceBlock>& blocks) {
  SurfaceUpdate update;
  update.header(dds::MakeHeader(Time{std::chrono::seconds(number)}, dds::kMapFrame));
  update.session(session);
  update.number(number);
  update.full(full);
  update.voxel_size_m(0.05);
  update.blocks(blocks);
  return dds::Encode<topics::SurfaceUpdates>(update);
}

TEST(UpdateFollower, ABlockOfTheSurfaceIsReplacedWholeAndGoesWithoutVertices) {
  const auto follower = MakeUpdateFollower(topics::SurfaceUpdates::kName);
  follower->Follow(SurfaceSample(3, 1, false, {Block(1, 3)}));
  EXPECT_FALSE(follower->FullCopy()) << "what came before is not known";
  follower->Follow(SurfaceSample(3, 1, true, {Block(1, 3), Block(2, 3)}));
  follower->Follow(SurfaceSample(3, 2, false, {Block(1, 6), Block(2, 0), Block(3, 3)}));
  follower->Follow(SurfaceSample(3, 4, false, {Block(4, 3)}));  // after a gap
  const auto copy = dds::Decode<topics::SurfaceUpdates>(*follower->FullCopy());
  ASSERT_TRUE(copy);
  EXPECT_TRUE(copy->full());
  EXPECT_EQ(copy->session(), 3U);
  EXPECT_EQ(copy->number(), 2U);
  EXPECT_EQ(copy->header().stamp().sec(), 2);
  ASSERT_EQ(copy->blocks().size(), 2U);
  EXPECT_EQ(copy->blocks()[0], Block(1, 6));
  EXPECT_EQ(copy->blocks()[1], Block(3, 3));
}

}  // namespace
}  // namespace thalweg::recorder
