#include "common/dds/topic_table.h"

#include <gtest/gtest.h>

#include <set>

#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

TEST(TopicTable, HoldsEveryTopicOnceWithItsType) {
  std::set<std::string> names;
  for (const TopicInfo& topic : AllTopics()) {
    EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
    EXPECT_NE(topic.type_name.find("::msg::dds_::"), std::string::npos) << topic.type_name;
  }
  ASSERT_NE(FindTopic("depth/points"), nullptr);
  EXPECT_EQ(FindTopic("depth/points")->type_name, "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_EQ(FindTopic("depth/points")->writers, Writers::kOne);
  EXPECT_EQ(FindTopic("health")->writers, Writers::kMany);
  EXPECT_EQ(FindTopic("no/such/topic"), nullptr);
}

TEST(TopicTable, WhatServicesWouldActOnIsReplayedOnlyIfNamed) {
  std::set<std::string> only_if_named;
  for (const TopicInfo& topic : AllTopics()) {
    if (topic.replay == Replay::kOnlyIfNamed) only_if_named.insert(topic.name);
    EXPECT_TRUE(topic.delivery != Delivery::kCommand || topic.replay == Replay::kOnlyIfNamed) << topic.name;
  }
  const std::set<std::string> expected = {topics::Path::kName,
                                          topics::PoseCommand::kName,
                                          topics::VelocityCommand::kName,
                                          topics::StampedVelocityCommand::kName,
                                          topics::Trajectory::kName,
                                          topics::OperatorCommands::kName,
                                          topics::CommandReplies::kName,
                                          topics::MapRequests::kName,
                                          topics::SurfaceRequests::kName,
                                          topics::ReplayCommands::kName,
                                          topics::ReplayStatus::kName,
                                          topics::Health::kName,
                                          topics::LinkUp::kName,
                                          topics::LinkDown::kName};
  EXPECT_EQ(only_if_named, expected);
}

TEST(TopicTable, DecodesWhatItEncodes) {
  thalweg_msgs::msg::MotionStatus status;
  status.header(MakeHeader(Time{std::chrono::seconds(3)}, kMapFrame));
  status.reason("path silent");
  status.distance_left_m(1.5);
  const std::vector<std::uint8_t> bytes = Encode<topics::MotionStatus>(status);
  const auto decoded = Decode<topics::MotionStatus>(bytes);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, status);
}

TEST(TopicTable, RefusesBytesThatEndTooSoon) {
  thalweg_msgs::msg::MotionStatus status;
  status.reason("path silent");
  std::vector<std::uint8_t> bytes = Encode<topics::MotionStatus>(status);
  while (!bytes.empty()) {
    bytes.pop_back();
    EXPECT_FALSE(Decode<topics::MotionStatus>(bytes)) << bytes.size();
  }
}

}  // namespace
}  // namespace thalweg::dds
