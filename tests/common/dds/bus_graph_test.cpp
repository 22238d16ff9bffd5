#include "common/dds/bus_graph.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>

#include "common/base/version.h"
#include "common/dds/qos.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using testing::HasSubstr;
using std::chrono_literals::operator""ms;

constexpr auto kOdometryType = "nav_msgs::msg::dds_::Odometry_";

Participant MakeParticipant(const std::string& id, const std::string& name, const std::string& address) {
  Participant participant;
  participant.id = id;
  participant.name = name;
  participant.address = address;
  return participant;
}

/// A writer of "driver" and a reader of "mapper".
BusGraph Pair(const EndpointQos& offered, const EndpointQos& requested) {
  BusGraph graph;
  graph.participants = {MakeParticipant("01", "driver", "10.0.0.2"),
                        MakeParticipant("02", "mapper", "10.0.0.3")};
  graph.participants[1].process = "77";
  graph.endpoints = {{"01", true, WireTopic("odometry"), kOdometryType, offered},
                     {"02", false, WireTopic("odometry"), kOdometryType, requested}};
  return graph;
}

/// The only mismatch between the two, as a sentence; empty if they match.
std::string MismatchOf(const EndpointQos& offered, const EndpointQos& requested) {
  const std::vector<Mismatch> mismatches = FindMismatches(Pair(offered, requested));
  EXPECT_LE(mismatches.size(), 1U);
  return mismatches.empty() ? "" : mismatches[0].text;
}

/// Not one of another test that happens to use the same domain.
bool IsOwnRobot(const Participant& participant) {
  return participant.name == "robot" && participant.process == std::to_string(getpid());
}

TEST(BusGraph, AReaderThatRequestsWhatIsNotOfferedIsNamedInASentence) {
  const auto mismatches = FindMismatches(Pair({.reliable = false}, {.reliable = true}));
  ASSERT_EQ(mismatches.size(), 1U);
  EXPECT_EQ(mismatches[0].topic, "odometry");
  EXPECT_EQ(mismatches[0].text,
            "\"driver\" (10.0.0.2) offers best effort, \"mapper\" (77) requests reliable: nothing passes");
  EXPECT_EQ(mismatches[0].advice, "let the reader request best effort, or the writer offer reliable");
}

TEST(BusGraph, EveryPolicyThatDecidesAMatchIsCompared) {
  const EndpointQos none;
  EXPECT_EQ(MismatchOf(none, none), "");
  EXPECT_THAT(MismatchOf(none, {.durability = Durability::kTransientLocal}),
              HasSubstr("offers volatile, \"mapper\" (77) requests transient local"));
  EXPECT_THAT(MismatchOf({.deadline = 500ms}, {.deadline = 250ms}),
              HasSubstr("offers a deadline of 0.5 s, \"mapper\" (77) requests one of 0.25 s"));
  EXPECT_THAT(MismatchOf(none, {.deadline = 250ms}), HasSubstr("a deadline of infinite"));
  EXPECT_THAT(MismatchOf(none, {.liveliness = Liveliness::kManualByTopic}),
              HasSubstr("liveliness automatic, \"mapper\" (77) requests manual by topic"));
  EXPECT_THAT(MismatchOf(none, {.lease = 1000ms}), HasSubstr("a liveliness lease of infinite"));
  EXPECT_THAT(MismatchOf({.exclusive = true}, none), HasSubstr("exclusive ownership"));
  EXPECT_THAT(MismatchOf(none, {.by_source_stamp = true}), HasSubstr("order by reception"));
}

TEST(BusGraph, AWriterThatOffersMoreThanIsRequestedMatches) {
  const EndpointQos most{.reliable = true,
                         .durability = Durability::kPersistent,
                         .deadline = 10ms,
                         .liveliness = Liveliness::kManualByTopic,
                         .lease = 10ms,
                         .by_source_stamp = true};
  EXPECT_EQ(MismatchOf(most, {}), "");
  EXPECT_EQ(MismatchOf(most, {.deadline = 10ms, .lease = 10ms}), "");
}

TEST(BusGraph, DifferentTypesUnderOneNameAreAMismatchAndDifferentPartitionsAreNone) {
  BusGraph graph = Pair({}, {});
  graph.endpoints[1].type = "nav_msgs::msg::dds_::Path_";
  ASSERT_EQ(FindMismatches(graph).size(), 1U);
  EXPECT_THAT(FindMismatches(graph)[0].text, HasSubstr("publishes nav_msgs/msg/Odometry"));
  EXPECT_EQ(FindMismatches(graph)[0].advice,
            "give \"mapper\" (77) the type nav_msgs/msg/Odometry, which plain DDS writes as "
            "nav_msgs::msg::dds_::Odometry_");
  graph.endpoints[0].partitions = {"robot1"};
  EXPECT_TRUE(FindMismatches(graph).empty());
  graph.endpoints[1].partitions = {"other", "robot*"};
  EXPECT_EQ(FindMismatches(graph).size(), 1U);
}

TEST(BusGraph, TopicsOfRos2HaveTheirNameAndOthersNone) {
  EXPECT_EQ(TopicName(WireTopic("depth/points")), "depth/points");
  EXPECT_FALSE(TopicName("ros_discovery_info"));
  EXPECT_EQ(ShownTopic(WireTopic("depth/points")), "depth/points");
  EXPECT_EQ(ShownTopic("ros_discovery\ninfo"), "ros_discovery info");
}

// A writer that is best effort cannot be had from a Bus, so the reader asks for more than it is offered by
// being transient local.
TEST(BusGraph, WhoIsOnALiveBusIsListedWithProcessVersionAndQos) {
  BusOptions options = test::BusOptionsForTest("watcher");
  options.surveys = true;
  Bus watcher(options);
  Bus robot(test::BusOptionsForTest("robot"));
  Bus tool(test::BusOptionsForTest("tool"));
  TopicInfo odometry = InfoOf<topics::Odometry>();
  robot.AdvertiseBytes(odometry);
  odometry.delivery = Delivery::kState;
  tool.SubscribeBytes(odometry, [](const RawSample&) {});

  watcher.EveryWall(10ms, [] {});
  ASSERT_TRUE(watcher.SpinUntil([&] { return !FindMismatches(watcher.Graph()).empty(); }, test::kPatience));
  const BusGraph graph = watcher.Graph();
  const std::vector<Mismatch> mismatches = FindMismatches(graph);
  ASSERT_EQ(mismatches.size(), 1U);
  const std::string process = " (" + std::to_string(getpid()) + ")";
  EXPECT_EQ(mismatches[0].text, "\"robot\"" + process + " offers volatile, \"tool\"" + process +
                                    " requests transient local: nothing passes");
  const auto found = std::ranges::find_if(graph.participants, IsOwnRobot);
  ASSERT_NE(found, graph.participants.end());
  EXPECT_EQ(found->version, Version());
  EXPECT_EQ(found->vendor, "eProsima Fast DDS");
  EXPECT_FALSE(found->host.empty());
  const auto writer = std::ranges::find_if(graph.endpoints, [&](const Endpoint& endpoint) {
    return endpoint.participant == found->id && endpoint.writes;
  });
  ASSERT_NE(writer, graph.endpoints.end());
  EXPECT_EQ(TextOf(writer->qos), "reliable, volatile");
  EXPECT_EQ(writer->partitions, std::vector<std::string>{options.partition});
}

TEST(BusGraph, WhoLeavesIsForgottenWithItsEndpoints) {
  BusOptions options = test::BusOptionsForTest("watcher");
  options.surveys = true;
  Bus watcher(options);
  watcher.EveryWall(10ms, [] {});
  std::string id;
  const auto is_known = [&] {
    const BusGraph graph = watcher.Graph();
    const auto found = std::ranges::find_if(graph.participants, IsOwnRobot);
    if (found != graph.participants.end()) id = found->id;
    return !id.empty() && std::ranges::count(graph.endpoints, id, &Endpoint::participant) == 1;
  };
  {
    Bus robot(test::BusOptionsForTest("robot"));
    robot.AdvertiseBytes(InfoOf<topics::Odometry>());
    ASSERT_TRUE(watcher.SpinUntil(is_known, test::kPatience));
  }
  const auto is_forgotten = [&] {
    const BusGraph graph = watcher.Graph();
    return graph.Find(id) == nullptr && std::ranges::count(graph.endpoints, id, &Endpoint::participant) == 0;
  };
  EXPECT_TRUE(watcher.SpinUntil(is_forgotten, test::kPatience));
}

}  // namespace
}  // namespace thalweg::dds
