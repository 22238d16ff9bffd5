#include <gmock/gmock.h>

#include <chrono>
#include <span>
#include <stdexcept>
#include <thread>

#include "services/recorder/adapter/player.h"
#include "tests/services/recorder/support/recordings.h"
#include "tests/support/test_bus.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using test::OpenRecording;
using test::WriteRecording;
using thalweg::test::BusOptionsForTest;
using thalweg::test::kPatience;
using PlayerOptionsTest = test::ScratchFolder;

/// The message of the error with which a player refuses; empty if it does not.
std::string RefusalOf(const McapReader& reader, const PlayerOptions& options) {
  dds::Bus bus(BusOptionsForTest("player"));
  try {
    const Player player(reader, options, bus);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

/// A recording of a pose, and of a transform some time later.
void WritePoseAndTransform(const std::filesystem::path& name, Duration later) {
  RecordingFile file({.file = name}, {{.topic = "/odometry", .type = "nav_msgs/msg/Odometry"},
                                      {.topic = "/tf", .type = "tf2_msgs/msg/TFMessage"}});
  const std::vector<std::uint8_t> bytes(100);
  file.Write(0, 0, Time{}, Time{}, bytes);
  file.Write(1, 0, Time{later}, Time{later}, bytes);
  file.Close();
}

TEST_F(PlayerOptionsTest, WhatServicesWouldActOnIsReplayedOnlyWhenItIsNamed) {
  const std::span<const dds::TopicInfo> all = dds::AllTopics();
  WriteRecording(folder_ / "a.mcap", {all.begin(), all.end()}, 1);
  const OpenRecording recording(folder_ / "a.mcap");
  std::vector<std::string> played;
  for (const dds::TopicInfo& topic : all) {
    if (topic.replay == dds::Replay::kByDefault) played.push_back(topic.name);
  }
  dds::Bus bus(BusOptionsForTest("all"));
  const Player player(recording.reader, {}, bus);
  EXPECT_EQ(player.topics(), played);
  for (const dds::TopicInfo& topic : all) {
    if (topic.replay == dds::Replay::kByDefault) continue;
    EXPECT_THAT(player.remarks(), testing::Contains(testing::HasSubstr(topic.name)));
  }
  EXPECT_THAT(player.remarks(),
              testing::Each(testing::AnyOf(testing::HasSubstr("what runs now would act on them; name them"),
                                           testing::HasSubstr("this replay itself is steered"))));
  dds::Bus other(BusOptionsForTest("named"));
  const Player named(recording.reader, {.topics = {"command/*", "replay/*", topics::OperatorCommands::kName}},
                     other);
  EXPECT_THAT(named.topics(),
              testing::UnorderedElementsAre(topics::PoseCommand::kName, topics::VelocityCommand::kName,
                                            topics::StampedVelocityCommand::kName, topics::Trajectory::kName,
                                            topics::OperatorCommands::kName));
}

TEST_F(PlayerOptionsTest, CommandsOfARobotWithANameAreLeftOutAsWellAndNoneHidesBehindASecondSlash) {
  dds::TopicInfo of_robot = dds::InfoOf<topics::PoseCommand>();
  of_robot.name = "r2/" + of_robot.name;
  dds::TopicInfo hidden = dds::InfoOf<topics::PoseCommand>();
  hidden.name = "/" + hidden.name;
  WriteRecording(folder_ / "a.mcap", {dds::InfoOf<topics::Odometry>(), of_robot, hidden}, 1);
  const OpenRecording recording(folder_ / "a.mcap");
  dds::Bus bus(BusOptionsForTest("all"));
  const Player player(recording.reader, {}, bus);
  EXPECT_THAT(player.topics(), testing::ElementsAre(topics::Odometry::kName));
  EXPECT_THAT(player.remarks(),
              testing::UnorderedElementsAre(
                  testing::HasSubstr("name them to play them: r2/command/pose"),
                  testing::HasSubstr("/command/pose is left out: it is not a name of ROS 2")));
  dds::Bus other(BusOptionsForTest("named"));
  const Player named(recording.reader, {.topics = {"*command/pose"}}, other);
  EXPECT_THAT(named.topics(), testing::ElementsAre(of_robot.name));
}

TEST_F(PlayerOptionsTest, ATopicIsRenamedByItsExactNameWithOrWithoutASlash) {
  WriteRecording(folder_ / "a.mcap", {dds::InfoOf<topics::LeftImage>(), dds::InfoOf<topics::Odometry>()}, 1);
  const OpenRecording recording(folder_ / "a.mcap");
  dds::Bus bus(BusOptionsForTest("renamed"));
  const Player player(recording.reader, {.remap = {{"/odometry", "/outside/odometry"}}}, bus);
  EXPECT_THAT(player.topics(),
              testing::ElementsAre(topics::LeftImage::kName, topics::OutsideOdometry::kName));
  EXPECT_EQ(RefusalOf(recording.reader, {.remap = {{"stereo/*", "x"}}}),
            "cannot rename stereo/* to x: both must be names, without *");
  EXPECT_EQ(RefusalOf(recording.reader, {.remap = {{"odometry", "x/*"}}}),
            "cannot rename odometry to x/*: both must be names, without *");
  EXPECT_THAT(RefusalOf(recording.reader, {.topics = {"odometry"}, .remap = {{"odometry", "depth/points"}}}),
              testing::AllOf(testing::HasSubstr("none of the topics to be played: "),
                             testing::HasSubstr("depth/points carries sensor_msgs/msg/PointCloud2")));
  EXPECT_EQ(RefusalOf(recording.reader, {.remap = {{"odometr", "x"}}}),
            "cannot rename odometr: the recording has no such topic");
}

TEST_F(PlayerOptionsTest, AStartBeyondTheEndIsRefusedWithALengthThatIsAccepted) {
  WriteRecording(folder_ / "a.mcap", {dds::InfoOf<topics::Odometry>()}, 6);
  const OpenRecording recording(folder_ / "a.mcap");
  EXPECT_EQ(RefusalOf(recording.reader, {.start = 0.2}),
            "the start must be 0 to 0.100 s, the recording's length");
  EXPECT_EQ(RefusalOf(recording.reader, {.start = 0.1}), "");
}

TEST_F(PlayerOptionsTest, ASelectionWithoutMessagesIsRefused) {
  WritePoseAndTransform(folder_ / "a.mcap", std::chrono::seconds(2));
  const OpenRecording recording(folder_ / "a.mcap");
  EXPECT_EQ(RefusalOf(recording.reader, {.start = 1.0, .topics = {"tf"}}), "");
  EXPECT_EQ(RefusalOf(recording.reader, {.loop = true, .start = 1.0, .topics = {"odometry"}}),
            "the topics to be played have no message that can be read from the start on");
  EXPECT_THAT(RefusalOf(recording.reader, {.loop = true, .start = 2.0}),
              testing::HasSubstr("it takes less than 10 ms"));
}

TEST_F(PlayerOptionsTest, EachLoopTakesAsLongAsTheRecording) {
  WritePoseAndTransform(folder_ / "a.mcap", std::chrono::milliseconds(200));
  const OpenRecording recording(folder_ / "a.mcap");
  dds::Bus player_bus(BusOptionsForTest("player"));
  dds::Bus listener(BusOptionsForTest("listener"));
  Player player(recording.reader, {.loop = true, .topics = {"odometry"}}, player_bus);
  int heard = 0;
  listener.SubscribeBytes(dds::InfoOf<topics::Odometry>(), [&](const dds::RawSample&) { ++heard; });
  ASSERT_TRUE(player.AwaitReaders(kPatience));
  ASSERT_TRUE(listener.SpinUntil([&] { return listener.Writers<topics::Odometry>() > 0; }, kPatience));
  const auto begin = std::chrono::steady_clock::now();
  const std::jthread playing([&](const std::stop_token& stop) { player.Run(stop); });
  EXPECT_TRUE(listener.SpinUntil([&] { return heard >= 4; }, kPatience));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(600)) << "three whole loops";
}

}  // namespace
}  // namespace thalweg::recorder
