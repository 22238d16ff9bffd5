#include "services/recorder/adapter/copy.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "services/recorder/adapter/describe.h"
#include "tests/services/recorder/support/recordings.h"
#include "tests/support/full_disk.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using test::OpenRecording;
using test::Samples;
using test::SamplesIn;
using test::WriteRecording;
using thalweg::test::FullDisk;
using CopyTest = test::ScratchFolder;

TEST_F(CopyTest, PartsBeginWithWhatHoldsWhichStandsOnceInTheirMerge) {
  const auto states = dds::InfoOf<topics::StaticTransforms>();
  tf2_msgs::msg::TFMessage frames;
  frames.transforms().emplace_back().child_frame_id("camera");
  const auto still = dds::Encode<topics::StaticTransforms>(frames);
  const std::vector<std::uint8_t> pose = {1, 2, 3};
  const auto at = [](int seconds) { return Time{std::chrono::seconds(seconds)}; };
  RecordingFile file({.file = folder_ / "a.mcap", .split_after = std::chrono::seconds(5)},
                     {{.topic = "/odometry", .type = "nav_msgs/msg/Odometry"}});
  file.Hold(file.AddChannel({.topic = "/tf_static", .type = dds::Ros2TypeName(states.type_name)}), states);
  file.Write(1, 4, at(1), at(0), still);
  for (int second = 1; second < 16; ++second) file.Write(0, 0, at(second), at(second), pose);
  file.Close();
  ASSERT_EQ(file.files().size(), 3U);
  std::vector<std::unique_ptr<OpenRecording>> parts;
  std::vector<const McapReader*> readers;
  for (std::size_t k = 0; k < 3; ++k) {
    parts.push_back(std::make_unique<OpenRecording>(file.files()[k]));
    readers.push_back(&parts.back()->reader);
    MessageCursor cursor = parts.back()->reader.Read();
    const auto first = cursor.Next();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->log_time, at(1 + 5 * static_cast<int>(k)));
    EXPECT_EQ(first->publish_time, at(0));
    EXPECT_EQ(first->sequence, 4U);
    EXPECT_TRUE(std::ranges::equal(first->payload, still));
  }
  EXPECT_EQ(Copy(readers, {}, {.file = folder_ / "merged.mcap"}).messages, 16U);
  const Samples merged = SamplesIn(OpenRecording(folder_ / "merged.mcap").reader);
  EXPECT_THAT(merged.at("/tf_static"), testing::ElementsAre(still));
  EXPECT_EQ(merged.at("/odometry").size(), 15U);
}

TEST_F(CopyTest, WhatPartsSayOfTheScenarioStandsOnceInTheirMerge) {
  const Metadata tiny{"scenario", {{"name", "tiny"}}};
  const Metadata flat{"scenario", {{"name", "flat"}}};
  std::vector<std::unique_ptr<OpenRecording>> parts;
  std::vector<const McapReader*> readers;
  for (const auto& [name, metadata] : {std::pair{"a", tiny}, {"b", tiny}, {"c", flat}}) {
    const std::filesystem::path file = folder_ / (std::string(name) + ".mcap");
    RecordingFile({.file = file, .metadata = {metadata}}, {}).Close();
    readers.push_back(&parts.emplace_back(std::make_unique<OpenRecording>(file))->reader);
  }
  Copy(readers, {}, {.file = folder_ / "merged.mcap"});
  const OpenRecording merged(folder_ / "merged.mcap");
  EXPECT_THAT(merged.reader.metadata(), testing::UnorderedElementsAre(tiny, flat));
  const std::vector<std::string> lines = Describe(merged.reader);
  EXPECT_EQ(std::ranges::count(lines, "scenario     name: tiny"), 1);
  EXPECT_EQ(std::ranges::count(lines, "scenario     name: flat"), 1);
}

TEST_F(CopyTest, AttachmentsAreCopiedOnceAndListed) {
  const std::vector<std::uint8_t> data(5'000'000, 'x');
  const Attachment calibration{.log_time_ns = 1, .name = "cal.yaml", .media_type = "text/yaml", .data = data};
  Attachment map = calibration;
  map.name = "map.ot";
  const std::vector<std::uint8_t> bytes(10);
  std::vector<std::unique_ptr<OpenRecording>> recordings;
  std::vector<const McapReader*> readers;
  const std::vector<std::vector<Attachment>> attached = {{calibration, map}, {calibration}};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::filesystem::path name = folder_ / (std::to_string(k) + ".mcap");
    RecordingFile file({.file = name, .attachments = attached[k]}, {{.topic = "/a", .type = "a/msg/A"}});
    for (const auto second : {1, 9}) file.Write(0, 0, Time{std::chrono::seconds(second)}, Time{}, bytes);
    file.Close();
    readers.push_back(&recordings.emplace_back(std::make_unique<OpenRecording>(name))->reader);
  }
  const Copied copied =
      Copy(readers, {}, {.file = folder_ / "merged.mcap", .split_after = std::chrono::seconds(5)});
  ASSERT_EQ(copied.files.size(), 2U);
  const OpenRecording first(copied.files[0]);
  EXPECT_TRUE(first.reader.Check().empty());
  EXPECT_THAT(first.reader.attachments(), testing::ElementsAre(calibration, map));
  EXPECT_THAT(OpenRecording(copied.files[1]).reader.attachments(), testing::IsEmpty());
  EXPECT_THAT(Describe(first.reader), testing::Contains("attachment   cal.yaml (text/yaml), 5.0 MB"));
}

TEST_F(CopyTest, ACopyThatFindsNoRoomLeavesNothingThatStandsInTheWayOfTheNext) {
  WriteRecording(folder_ / "a.mcap", {dds::InfoOf<topics::Odometry>()}, 2000);
  const OpenRecording recording(folder_ / "a.mcap");
  const auto copy = [&] {
    Copy({&recording.reader}, {}, {.file = folder_ / "b.mcap", .compression = Compression::kNone});
  };
  for (const rlim_t room : {0U, 50'000U}) {  // for not even its head, and for a part
    const FullDisk full(room);
    EXPECT_THROW(copy(), std::runtime_error);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "b.mcap")) << room;
  }
  copy();
  const OpenRecording copied(folder_ / "b.mcap");
  EXPECT_EQ(copied.reader.message_count(), 2000U);
  const FullDisk full(0);
  EXPECT_THROW(copy(), std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.mcap")) << "what was there before is not removed";
}

TEST_F(CopyTest, APartBeginsWithWhatIsSaidOnceAndHoldsFromThenOn) {
  const auto updates_topic = dds::InfoOf<topics::MapUpdates>();
  const auto channel = [](const dds::TopicInfo& topic) {
    return Channel{.topic = '/' + topic.name, .type = dds::Ros2TypeName(topic.type_name)};
  };
  dds::MapLog log(7, 0.1);
  OccupancyGrid grid(0.1);
  tf2_msgs::msg::TFMessage frames;
  frames.transforms().emplace_back().child_frame_id("odom");
  const auto still = dds::Encode<topics::StaticTransforms>(frames);
  const auto pose = dds::Encode<topics::Odometry>(nav_msgs::msg::Odometry());
  {
    RecordingFile file({.file = folder_ / "a.mcap"},
                       {channel(dds::InfoOf<topics::StaticTransforms>()), channel(updates_topic),
                        channel(dds::InfoOf<topics::Odometry>())});
    file.Write(0, 0, Time{}, Time{}, still);
    file.Write(1, 0, Time{}, Time{}, dds::Encode<topics::MapUpdates>(log.FullCopy(grid)));
    for (int k = 0; k < 10; ++k) {
      const Time time{std::chrono::seconds(k)};
      file.Write(2, 0, time, time, pose);
      file.Write(1, 0, time, time, dds::Encode<topics::MapUpdates>(log.TakeUpdate()));
    }
    file.Close();
  }
  const OpenRecording whole(folder_ / "a.mcap");
  const Time start{std::chrono::milliseconds(5500)};
  EXPECT_TRUE(Copy({&whole.reader}, {.start = start}, {.file = folder_ / "part.mcap"}).problems.empty());
  const OpenRecording part(folder_ / "part.mcap");
  EXPECT_EQ(part.reader.start(), start);
  const Samples samples = SamplesIn(part.reader);
  EXPECT_THAT(samples.at("/tf_static"), testing::ElementsAre(still));
  EXPECT_EQ(samples.at("/odometry").size(), 4U);
  ASSERT_EQ(samples.at("/map/updates").size(), 5U);
  const auto full = dds::Decode<topics::MapUpdates>(samples.at("/map/updates")[0]);
  const auto next = dds::Decode<topics::MapUpdates>(samples.at("/map/updates")[1]);
  ASSERT_TRUE(full && next);
  EXPECT_TRUE(full->full());
  EXPECT_EQ(full->session(), next->session());
  EXPECT_EQ(full->number() + 1, next->number());
  MessageCursor cursor = part.reader.Read();
  EXPECT_EQ(cursor.Next()->publish_time, Time{}) << "when it was sent";

  const Copied split =
      Copy({&whole.reader}, {}, {.file = folder_ / "split.mcap", .split_after = std::chrono::seconds(5)});
  ASSERT_EQ(split.files.size(), 2U);
  const Samples second = SamplesIn(OpenRecording(split.files[1]).reader);
  EXPECT_THAT(second.at("/tf_static"), testing::ElementsAre(still));
  EXPECT_EQ(second.at("/map/updates").size(), 6U);
  const auto copy = dds::Decode<topics::MapUpdates>(second.at("/map/updates")[0]);
  ASSERT_TRUE(copy);
  EXPECT_TRUE(copy->full());

  EXPECT_TRUE(
      Copy({&whole.reader}, {.start = start, .topics = {"odometry"}}, {.file = folder_ / "poses.mcap"})
          .problems.empty());
  EXPECT_EQ(SamplesIn(OpenRecording(folder_ / "poses.mcap").reader).size(), 1U);
}

}  // namespace
}  // namespace thalweg::recorder
