#include "services/cli/adapter/outside_topics.h"

#include <gmock/gmock.h>

#include "tests/services/inspector/adapter/pose_type.h"

namespace thalweg::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

dds::BusGraph GraphWith(const std::vector<std::string>& topics,
                        const std::string& type = inspector::kPoseType) {
  dds::BusGraph graph;
  for (const std::string& topic : topics) {
    graph.endpoints.push_back(
        {.participant = "01", .writes = true, .topic = dds::WireTopic(topic), .type = type});
  }
  return graph;
}

std::vector<std::string> NewNames(OutsideTopics& topics, const dds::BusGraph& graph) {
  std::vector<std::string> names;
  for (const auto& topic : topics.FindNew(graph)) names.push_back(topic ? topic->info.name : topic.error());
  return names;
}

TEST(OutsideTopics, AreThoseThatTheTableDoesNotHaveEachOnce) {
  OutsideTopics topics({}, dds::Names{});
  EXPECT_THAT(NewNames(topics, GraphWith({"camera/pose", "outside/pose"})), ElementsAre("/camera/pose"));
  EXPECT_THAT(NewNames(topics, GraphWith({"camera/pose", "arm/pose"})), ElementsAre("/arm/pose"));
}

TEST(OutsideTopics, OfSeveralRobotsThoseOfItsOwn) {
  OutsideTopics topics({}, dds::Names{.robot = "r2", .topics = {}, .frames = {}});
  EXPECT_THAT(NewNames(topics, GraphWith({"r1/camera/pose", "r2/camera/pose", "r2/outside/pose"})),
              ElementsAre("/r2/camera/pose"));
}

TEST(OutsideTopics, WhatCannotBeDecodedIsNamed) {
  OutsideTopics topics({}, dds::Names{});
  EXPECT_THAT(NewNames(topics, GraphWith({"robot/state"}, "my_robot::msg::dds_::State_")),
              ElementsAre(HasSubstr("robot/state carries my_robot/msg/State")));
}

TEST(OutsideTopics, APatternThatNothingMatchesIsSaidWithWhatIsNearest) {
  OutsideTopics topics({"camera/*", "/odometri"}, dds::Names{});
  EXPECT_THAT(topics.Unmatched(),
              ElementsAre("nobody publishes camera/* yet; it is recorded once somebody does",
                          "nobody publishes /odometri yet; it is recorded once somebody does; did you mean "
                          "odometry?"));
  EXPECT_THAT(NewNames(topics, GraphWith({"camera/pose", "arm/pose"})), ElementsAre("/camera/pose"));
  EXPECT_THAT(topics.Unmatched(), ElementsAre(HasSubstr("/odometri")));
  EXPECT_THAT(OutsideTopics({}, dds::Names{}).Unmatched(), IsEmpty());
}

}  // namespace
}  // namespace thalweg::cli
