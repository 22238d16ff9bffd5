#include "services/inspector/adapter/open_topic.h"

#include <gmock/gmock.h>

#include <sstream>

#include "services/inspector/core/standard_types.h"
#include "tests/services/inspector/adapter/pose_type.h"

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;

/// A bus on which "driver" publishes robot/pose.
dds::BusGraph GraphOfDriver(const std::string& type, const dds::EndpointQos& qos) {
  dds::Participant driver;
  driver.id = "01";
  driver.name = "driver";
  driver.process = "77";
  dds::BusGraph graph;
  graph.participants = {driver};
  graph.endpoints = {{"01", true, dds::WireTopic("robot/pose"), type, qos}};
  return graph;
}

TEST(OpenTopic, ATopicOfTheTableNeedsNobodyOnTheBus) {
  const std::string name = dds::InfoOf<dds::topics::Octomap>().name;
  const auto topic = FindOpenTopic(std::string("/").append(name), "", {});
  ASSERT_TRUE(topic) << topic.error();
  EXPECT_EQ(topic->info.name, name);
  EXPECT_EQ(topic->type, "octomap_msgs/msg/Octomap");
  EXPECT_EQ(topic->info.delivery, dds::Delivery::kState);
}

TEST(OpenTopic, ANameIsUnderstoodAsRos2WritesItAndAsItIsOnTheWire) {
  EXPECT_EQ(TopicNameFrom("robot/pose"), "robot/pose");
  EXPECT_EQ(TopicNameFrom("/robot/pose"), "robot/pose");
  EXPECT_EQ(TopicNameFrom(dds::WireTopic("robot/pose")), "robot/pose");
  EXPECT_EQ(TopicNameFrom('/' + dds::WireTopic("robot/pose")), "robot/pose");
}

TEST(OpenTopic, ReportsTheOtherMachinesThatPublishIt) {
  dds::BusGraph graph = GraphOfDriver(kPoseType, {});
  graph.participants[0].host = "robot-1";
  EXPECT_THAT(OtherHostsOf("robot/pose", graph, "base"), testing::ElementsAre("robot-1"));
  EXPECT_TRUE(OtherHostsOf("robot/pose", graph, "robot-1").empty());
  EXPECT_TRUE(OtherHostsOf("robot/twist", graph, "base").empty());
}

TEST(OpenTopic, ATopicThatLacksItsPrefixOnTheWireIsTheReasonThatNothingArrives) {
  dds::BusGraph graph = GraphOfDriver(kPoseType, {});
  graph.endpoints[0].topic = "robot/pose";
  EXPECT_THAT(WhyNothingArrives("robot/pose", graph),
              HasSubstr("without the prefix that ROS 2's topics have on the wire: it must be " +
                        dds::WireTopic("robot/pose")));
}

TEST(OpenTopic, ReadsMessagesAsLargeAsTheTableAllowsAndOfOthersAsAMap) {
  EXPECT_EQ(FindOpenTopic(dds::InfoOf<dds::topics::DepthPoints>().name, "", {})->info.most_bytes,
            dds::kMostImageBytes);
  EXPECT_EQ(FindOpenTopic("robot/pose", "", GraphOfDriver(kPoseType, {}))->info.most_bytes,
            dds::kMostMapBytes);
}

TEST(OpenTopic, AnotherTopicHasTheTypeOfWhoPublishesItOrTheOneThatIsGiven) {
  const auto found = FindOpenTopic("robot/pose", "", GraphOfDriver(kPoseType, {}));
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->type, "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(found->info.type_name, kPoseType);
  const auto given = FindOpenTopic("robot/twist", "geometry_msgs/Twist", {});
  ASSERT_TRUE(given) << given.error();
  EXPECT_EQ(given->type, "geometry_msgs/msg/Twist");
}

TEST(OpenTopic, AnotherTypeThanTheTopicCarriesIsRefused) {
  EXPECT_EQ(FindOpenTopic("robot/pose", "nav_msgs/Path", GraphOfDriver(kPoseType, {})).error(),
            "robot/pose carries geometry_msgs/msg/PoseStamped, not nav_msgs/msg/Path");
  const std::string known = dds::InfoOf<dds::topics::Octomap>().name;
  EXPECT_THAT(FindOpenTopic(known, "nav_msgs/msg/Path", {}).error(),
              HasSubstr("carries octomap_msgs/msg/Octomap, not nav_msgs/msg/Path"));
}

TEST(OpenTopic, TheReaderTakesWhatTheWritersOffer) {
  const auto delivery = [](const dds::EndpointQos& qos) {
    return FindOpenTopic("robot/pose", "", GraphOfDriver(kPoseType, qos))->info.delivery;
  };
  EXPECT_EQ(delivery({.reliable = false}), dds::Delivery::kSamples);
  EXPECT_EQ(delivery({.reliable = true}), dds::Delivery::kLog);
  EXPECT_EQ(delivery({.reliable = true, .durability = dds::Durability::kTransientLocal}),
            dds::Delivery::kState);
}

TEST(OpenTopic, WhatCannotBeDecodedIsNamedWithWhatCouldHelp) {
  EXPECT_THAT(
      FindOpenTopic("robot/pos", "", GraphOfDriver(kPoseType, {})).error(),
      HasSubstr(
          "nobody publishes or subscribes to robot/pos; the topics of this bus are robot/pose; did you mean "
          "robot/pose?"));
  EXPECT_THAT(FindOpenTopic("robot/pos", "", {}).error(), HasSubstr("is it the right --domain?"));
  EXPECT_THAT(
      FindOpenTopic("robot/pose", "", GraphOfDriver("my_robot::msg::dds_::State_", {}), {"/msgs"}).error(),
      HasSubstr("robot/pose carries my_robot/msg/State: my_robot/State is not defined: neither here nor in "
                "/msgs; name the folder"));
  dds::BusGraph two = GraphOfDriver(kPoseType, {});
  two.endpoints.push_back({"01", false, dds::WireTopic("robot/pose"), "geometry_msgs::msg::dds_::Twist_"});
  EXPECT_THAT(FindOpenTopic("robot/pose", "", two).error(), HasSubstr("choose one with --type"));
}

TEST(OpenTopic, StandardTypesAreKnownThoughNoTopicOfOursHasThem) {
  const auto topic =
      FindOpenTopic("robot/pose", "", GraphOfDriver("sensor_msgs::msg::dds_::LaserScan_", {}), {});
  ASSERT_TRUE(topic) << topic.error();
  EXPECT_EQ(topic->type, "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(topic->schema.message(0).fields.size(), 10U);
}

TEST(OpenTopic, EveryStandardTypeHasAllThatItContains) {
  std::istringstream lines{std::string(StandardTypes())};
  int types = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("MSG: ")) continue;
    ++types;
    const std::string name = line.substr(5);  // package/Type
    const std::string type = name.substr(0, name.find('/')) + "/msg" + name.substr(name.find('/'));
    const auto topic = FindOpenTopic("robot/pose", type, {}, {});
    EXPECT_TRUE(topic) << topic.error();
  }
  EXPECT_GT(types, 100);
}

TEST(OpenTopic, SilenceIsExplainedByWhoPublishes) {
  EXPECT_EQ(WhyNothingArrives("/robot/pose", GraphOfDriver(kPoseType, {})),
            "robot/pose is published by \"driver\" (77), but nothing has come yet");
  EXPECT_EQ(WhyNothingArrives("other", GraphOfDriver(kPoseType, {})), "nobody publishes other yet");
}

}  // namespace
}  // namespace thalweg::inspector
