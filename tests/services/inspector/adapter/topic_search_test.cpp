#include "services/inspector/adapter/topic_search.h"

#include <gmock/gmock.h>

#include "tests/services/inspector/adapter/pose_type.h"

namespace thalweg::inspector {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

dds::Endpoint WriterOf(const std::string& topic, const std::string& type = kPoseType) {
  return {.participant = "01", .writes = true, .topic = dds::WireTopic(topic), .type = type};
}

std::vector<std::string> NamesOf(const std::vector<Result<OpenTopic>>& topics) {
  std::vector<std::string> names;
  for (const auto& topic : topics) names.push_back(topic ? topic->info.name : topic.error());
  return names;
}

TEST(TopicSearch, EachTopicIsReturnedOnceAsSomebodyPublishesIt) {
  TopicSearch search([](const std::string& topic) { return topic != "unwanted"; }, {});
  dds::BusGraph graph;
  graph.endpoints = {WriterOf("pose"), WriterOf("unwanted"), WriterOf("read"), WriterOf("pose")};
  graph.endpoints[2].writes = false;
  EXPECT_THAT(NamesOf(search.FindNew(graph)), ElementsAre("pose"));
  EXPECT_TRUE(search.FindNew(graph).empty());
  graph.endpoints.push_back(WriterOf("later"));
  EXPECT_THAT(NamesOf(search.FindNew(graph)), ElementsAre("later"));
  EXPECT_THAT(search.found(), ElementsAre("later", "pose"));
}

TEST(TopicSearch, ATopicComesWithTheDefinitionOfItsType) {
  TopicSearch search([](const std::string&) { return true; }, {});
  dds::BusGraph graph;
  graph.endpoints = {WriterOf("pose")};
  const auto topics = search.FindNew(graph);
  ASSERT_EQ(topics.size(), 1U);
  ASSERT_TRUE(topics[0]) << topics[0].error();
  EXPECT_EQ(topics[0]->type, "geometry_msgs/msg/PoseStamped");
  EXPECT_THAT(topics[0]->definition, HasSubstr("geometry_msgs/Pose pose"));
}

TEST(TopicSearch, ATopicOfATypeThatIsDefinedNowhereIsReturnedOnceAsAnError) {
  TopicSearch search([](const std::string&) { return true; }, {});
  dds::BusGraph graph;
  graph.endpoints = {WriterOf("robot/state", "my_robot::msg::dds_::State_")};
  EXPECT_THAT(NamesOf(search.FindNew(graph)),
              ElementsAre(HasSubstr("robot/state carries my_robot/msg/State")));
  EXPECT_TRUE(search.FindNew(graph).empty());
}

}  // namespace
}  // namespace thalweg::inspector
