// `thalweg topic`, `thalweg node` and `thalweg doctor` as typed by a user.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/dds/bus.h"
#include "common/dds/schema.h"
#include "tests/support/outcome.h"
#include "tests/support/places.h"
#include "tests/support/test_bus.h"

namespace thalweg::cli {
namespace {

using test::Outcome;
using testing::HasSubstr;
using testing::Not;

/// A robot that has published how it moves; a late joiner still gets it.
class Inspect : public testing::Test {
 protected:
  using Topic = dds::topics::MotionStatus;

  Inspect() {
    setenv("THALWEG_DOMAIN", std::to_string(options_.domain).c_str(), 1);
    setenv("THALWEG_PARTITION", options_.partition.c_str(), 1);
    thalweg_msgs::msg::MotionStatus status;
    status.header().stamp().sec(12);
    status.header().frame_id("map");
    status.state(thalweg_msgs::msg::MOTION_STOPPED);
    status.stop_reason(thalweg_msgs::msg::STOP_PATH_SILENT);
    status.reason("path silent\x1b[2J");
    status.distance_left_m(1.5);
    EXPECT_TRUE(publisher_.Write(status));
  }

  static Outcome Thalweg(const std::string& arguments) {
    return test::OutcomeOf(test::BinFolder() + "/thalweg " + arguments);
  }

  /// Without what goes to the standard error: JSON stands alone on the standard output.
  static Outcome Doctor() {
    std::string command = "{ ";
    command += test::BinFolder() + "/thalweg doctor --json --out " + testing::TempDir() + " 2> /dev/null; }";
    return test::OutcomeOf(command);
  }

  const dds::BusOptions options_ = test::BusOptionsForTest("robot");
  dds::Bus bus_{options_};
  dds::Bus::Publisher<Topic> publisher_ = bus_.Advertise<Topic>();
  const std::string name_ = Topic::kName;
};

TEST_F(Inspect, EchoPrintsAMessageAsYamlAPartOfItALineOrCsv) {
  const Outcome yaml = Thalweg("topic echo --once --timeout 20 /" + name_);
  EXPECT_EQ(yaml.exit_code, 0);
  EXPECT_EQ(yaml.text,
            "header:\n  stamp:\n    sec: 12\n    nanosec: 0\n  frame_id: map\n"
            "path_stamp:\n  sec: 0\n  nanosec: 0\nstate: 3\nstop_reason: 5\nreason: \"path silent\\x1b[2J\"\n"
            "distance_done_m: 0.0\ndistance_left_m: 1.5\nspeed_mps: 0.0\n---\n");
  EXPECT_EQ(Thalweg("topic echo --once --timeout 20 --field header.frame_id " + name_).text, "map\n---\n");
  EXPECT_THAT(
      Thalweg("topic echo --once --timeout 20 --line " + name_).text,
      HasSubstr(
          "12.000 map  path_stamp=0.000  state=STOPPED  stop_reason=PATH_SILENT  reason=\"path silent"));
  EXPECT_THAT(Thalweg("topic echo --once --timeout 20 --csv --field distance_left_m " + name_).text, "1.5\n");
}

TEST_F(Inspect, ATopicMayBeNamedAsItIsOnTheWire) {
  EXPECT_EQ(Thalweg("topic echo --once --timeout 20 --field header.frame_id " + dds::WireTopic(name_)).text,
            "map\n---\n");
}

TEST_F(Inspect, WhatIsMistypedIsNamed) {
  EXPECT_THAT(Thalweg("topic echo --field speed " + name_).text,
              HasSubstr("has no field \"speed\"; its fields are"));
  const Outcome unknown = Thalweg("topic echo no/such_topic");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.text,
              HasSubstr("nobody publishes or subscribes to no/such_topic; the topics of this bus are"));
  const Outcome silent =
      Thalweg("topic echo --once --timeout 0.5 " + std::string(dds::topics::Odometry::kName));
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.text, HasSubstr("within --timeout"));
}

TEST_F(Inspect, ListInfoAndNodesTellWhoPublishesWhat) {
  EXPECT_THAT(Thalweg("topic list --show-types").text,
              HasSubstr(name_ + " [thalweg_msgs/msg/MotionStatus]\n"));
  const Outcome info = Thalweg("topic info " + name_);
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_THAT(info.text, HasSubstr("Publisher count: 1\n  \"robot\" (" + std::to_string(getpid()) +
                                   "): reliable, transient local"));
  EXPECT_THAT(Thalweg("node list").text, HasSubstr("robot"));
  EXPECT_THAT(Thalweg("node info robot").text, HasSubstr("publishes\n    " + name_));
  EXPECT_THAT(Thalweg("node info nobody").text, HasSubstr("there is no node nobody"));
}

TEST_F(Inspect, AMessageGivenInYamlReachesAllWhoSubscribe) {
  std::string first_reason;
  std::string second_reason;
  dds::Bus first(test::BusOptionsForTest("first"));
  dds::Bus second(test::BusOptionsForTest("second"));
  first.Subscribe<dds::topics::CommandReplies>([&](const auto& message) { first_reason = message.reason(); });
  second.Subscribe<dds::topics::CommandReplies>(
      [&](const auto& message) { second_reason = message.reason(); });
  const Outcome outcome = Thalweg("topic pub --once " + std::string(dds::topics::CommandReplies::kName) +
                                  " '{header: {stamp: now}, reason: hello}'");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("published 1 to 2 subscribers"));
  EXPECT_TRUE(first.SpinUntil([&] { return first_reason == "hello"; }, test::kPatience));
  EXPECT_TRUE(second.SpinUntil([&] { return second_reason == "hello"; }, test::kPatience));
}

TEST_F(Inspect, AMistakeInAMessageIsNamedBeforeAnybodyIsWaitedFor) {
  const Outcome outcome = Thalweg("topic pub --once " + name_ + " '{state: fast}'");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("state: \"fast\" is no uint32"));
}

/// A robot that also has a cloud of 50000 points, 800 KB, which no argument of a command can hold.
class InspectCloud : public Inspect {
 protected:
  using CloudTopic = dds::topics::OccupiedPoints;

  InspectCloud() {
    cloud_.header().frame_id("map");
    cloud_.height(1);
    cloud_.width(50'000);
    cloud_.point_step(16);
    cloud_.row_step(cloud_.point_step() * cloud_.width());
    cloud_.data().resize(cloud_.row_step());
    for (std::size_t k = 0; k < cloud_.data().size(); ++k)
      cloud_.data()[k] = static_cast<std::uint8_t>(k * 7);
    EXPECT_TRUE(clouds_.Write(cloud_));
  }

  sensor_msgs::msg::PointCloud2 cloud_;
  dds::Bus::Publisher<CloudTopic> clouds_ = bus_.Advertise<CloudTopic>();
  const std::string cloud_name_ = CloudTopic::kName;
};

TEST_F(InspectCloud, WhatEchoPrintedIsSentFromStandardInput) {
  dds::TopicInfo copy_of = dds::InfoOf<CloudTopic>();
  copy_of.name = "outside/cloud";
  copy_of.delivery = dds::Delivery::kLog;  // reliable, else a part could be lost
  std::vector<std::uint8_t> copy;
  dds::Bus reader(test::BusOptionsForTest("reader"));
  reader.SubscribeBytes(copy_of,
                        [&](const auto& sample) { copy.assign(sample.bytes.begin(), sample.bytes.end()); });
  const std::string file = testing::TempDir() + "/cloud-" + std::to_string(getpid()) + ".yaml";
  const std::string thalweg = test::BinFolder() + "/thalweg ";
  const Outcome echo = test::OutcomeOf("{ " + thalweg + "topic echo --once --full-length --timeout 20 " +
                                       cloud_name_ + " > " + file + "; }");
  EXPECT_EQ(echo.exit_code, 0) << echo.text;
  const Outcome pub =
      test::OutcomeOf("{ " + thalweg + "topic pub --once " + copy_of.name + " - < " + file + "; }");
  std::filesystem::remove(file);
  EXPECT_EQ(pub.exit_code, 0) << pub.text;
  EXPECT_TRUE(reader.SpinUntil([&] { return !copy.empty(); }, test::kPatience));
  EXPECT_TRUE(copy == dds::Encode<CloudTopic>(cloud_));
}

TEST_F(InspectCloud, ARowOfCsvHasAllElementsOrNoArray) {
  const Outcome whole = Thalweg("topic echo --once --timeout 20 --csv --field data " + cloud_name_);
  EXPECT_EQ(whole.exit_code, 0);
  EXPECT_EQ(std::ranges::count(whole.text, ',') + 1, 800'000);
  EXPECT_EQ(Thalweg("topic echo --once --timeout 20 --csv --no-arr " + cloud_name_).text,
            "0,0,map,1,50000,False,16,800000,False\n");
  const Outcome cut = Thalweg("topic echo --once --csv --truncate-length 3 " + cloud_name_);
  EXPECT_NE(cut.exit_code, 0) << "a program could not see that the row is cut";
  EXPECT_THAT(cut.text, HasSubstr("excludes"));
}

TEST_F(InspectCloud, APartThatNoMessageHasIsAFailure) {
  const Outcome outcome = Thalweg("topic echo --once --timeout 20 --field 'fields[99].name' " + cloud_name_);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("fields[99]: the message has only 0 elements there"));
}

TEST_F(Inspect, AnEmptyStandardInputIsNoMessage) {
  const Outcome outcome = Thalweg("topic pub --once " + name_ + " -");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("standard input, which is empty"));
}

TEST_F(Inspect, TheDoctorsExitCodeAndJsonTellOfAQosThatDoesNotFit) {
  const auto qos_of = [](const std::string& text) {
    std::vector<std::string> levels;
    for (const auto& finding : nlohmann::json::parse(text)) {
      if (finding["subject"] == "QoS") levels.push_back(finding["level"]);
    }
    return levels;
  };
  EXPECT_THAT(qos_of(Doctor().text), testing::ElementsAre("ok"));
  dds::Bus driver(test::BusOptionsForTest("driver"));
  dds::TopicInfo weak = dds::InfoOf<Topic>();
  weak.delivery = dds::Delivery::kSamples;  // volatile, where the reader asks for the latest on joining
  driver.AdvertiseBytes(weak);
  dds::Bus reader(test::BusOptionsForTest("reader"));
  reader.Subscribe<Topic>([](const auto&) {});
  const Outcome outcome = Doctor();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(qos_of(outcome.text), testing::ElementsAre("problem"));
  const Outcome nodes = Thalweg("node list");
  EXPECT_EQ(nodes.exit_code, 1);
  EXPECT_THAT(nodes.text,
              HasSubstr("\"driver\" (" + std::to_string(getpid()) + ") offers volatile, \"reader\""));
}

}  // namespace
}  // namespace thalweg::cli
