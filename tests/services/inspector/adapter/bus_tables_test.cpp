#include "services/inspector/adapter/bus_tables.h"

#include <gmock/gmock.h>

#include "tests/services/inspector/adapter/pose_type.h"

namespace thalweg::inspector {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

dds::Participant Node(const std::string& id, const std::string& name) {
  dds::Participant node;
  node.id = id;
  node.name = name;
  node.process = "7" + id;
  node.host = "vm";
  node.vendor = "eProsima Fast DDS";
  return node;
}

/// "zoe" publishes robot/pose, which "adam" and a nameless program read.
dds::BusGraph ThreeNodes() {
  dds::BusGraph graph;
  graph.participants = {Node("1", "zoe"), Node("2", "adam"), Node("3", "")};
  graph.participants[0].version = "1.2.3";
  graph.endpoints = {{"1", true, dds::WireTopic("robot/pose"), kPoseType, {.reliable = true}, {"a"}},
                     {"2", false, dds::WireTopic("robot/pose"), kPoseType, {.reliable = true}},
                     {"3", false, dds::WireTopic("robot/pose"), kPoseType, {}},
                     {"3", false, "private", "Other", {}}};
  return graph;
}

TEST(BusTables, ATopicHasItsTypesItsPublishersAndItsSubscribers) {
  const dds::BusGraph graph = ThreeNodes();
  const auto uses = TopicUses(graph);
  ASSERT_EQ(uses.size(), 2U);
  EXPECT_EQ(uses.begin()->first, "private") << "a topic that is none of ROS 2's keeps its name on the wire";
  const TopicUse& pose = uses.at("robot/pose");
  EXPECT_THAT(pose.types, ElementsAre("geometry_msgs/msg/PoseStamped"));
  EXPECT_EQ(pose.writers.size(), 1U);
  EXPECT_EQ(pose.readers.size(), 2U);
}

TEST(BusTables, NodesAreListedByNameWithWhatEachPublishesAndSubscribes) {
  const Rows rows = NodeRows(ThreeNodes());
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_THAT(rows[1], ElementsAre("(no name)", "vm", "73", "-", "eProsima Fast DDS", "0", "2"));
  EXPECT_EQ(rows[2][0], "adam");
  EXPECT_THAT(rows[3], ElementsAre("zoe", "vm", "71", "-", "thalweg 1.2.3, eProsima Fast DDS", "1", "0"));
}

TEST(BusTables, ANodeIsShownWithItsTopics) {
  const dds::BusGraph graph = ThreeNodes();
  EXPECT_EQ(NodeText(graph.participants[0]), "zoe: process 71 on vm, thalweg 1.2.3, eProsima Fast DDS");
  const Rows published = EndpointRows(graph, graph.participants[0], true);
  ASSERT_EQ(published.size(), 1U);
  EXPECT_EQ(published[0][0], "    robot/pose");
  EXPECT_EQ(published[0][1], "geometry_msgs/msg/PoseStamped");
  EXPECT_THAT(published[0][2], HasSubstr("reliable, volatile, partition a"));
  EXPECT_THAT(EndpointRows(graph, graph.participants[0], false), ElementsAre(ElementsAre("    nothing")));
}

TEST(BusTables, TheMismatchesOfANodeAreThoseInWhichItTakesPart) {
  dds::BusGraph graph = ThreeNodes();
  graph.endpoints[0].partitions.clear();
  graph.endpoints[0].qos.reliable = false;  // which adam does not accept
  EXPECT_EQ(MismatchesOf(graph, "").size(), 1U);
  EXPECT_EQ(MismatchesOf(graph, "adam").size(), 1U);
  EXPECT_EQ(MismatchesOf(graph, "zoe").size(), 1U);
  EXPECT_TRUE(MismatchesOf(graph, "eve").empty());
}

}  // namespace
}  // namespace thalweg::inspector
