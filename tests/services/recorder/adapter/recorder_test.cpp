#include "services/recorder/adapter/recorder.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <span>
#include <thread>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/copy.h"
#include "services/recorder/adapter/describe.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"
#include "tests/support/full_disk.h"
#include "tests/support/test_bus.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using test::BusOptionsForTest;
using test::FullDisk;
using test::kPatience;
using Samples = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;  // payloads by topic

/// A recording in memory that can be read.
struct OpenRecording {
  explicit OpenRecording(const std::filesystem::path& name)
      : file(name), reader(*McapReader::Open(file.bytes())) {}
  MappedFile file;
  McapReader reader;
};

class RecorderTest : public testing::Test {
 protected:
  RecorderTest() : folder_(testing::TempDir() + "/recorder-" + std::to_string(getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~RecorderTest() override { std::filesystem::remove_all(folder_); }

  /// Without health, which the recorder publishes itself.
  RecorderOptions Options() const {
    return {.recording = {.file = folder_ / "a.mcap"},
            .topics = {topics::Odometry::kName, topics::MapRequests::kName, topics::MotionStatus::kName,
                       topics::DepthPoints::kName}};
  }

  /// A recording of `count` odometries and map requests from another bus; returns what was sent.
  Samples Record(const RecorderOptions& options, int count) {
    dds::Bus sender(BusOptionsForTest("sender"));
    dds::Bus receiver(BusOptionsForTest("recorder"));
    const auto poses = sender.AdvertiseBytes(dds::InfoOf<topics::Odometry>());
    const auto requests = sender.AdvertiseBytes(dds::InfoOf<topics::MapRequests>());
    Recorder recorder(options, receiver);
    // The writing thread counts what it has written, which is no event of the bus.
    receiver.EveryWall(std::chrono::milliseconds(5), [] {});
    EXPECT_TRUE(sender.SpinUntil([&] { return poses.readers() > 0 && requests.readers() > 0; }, kPatience));
    EXPECT_TRUE(receiver.SpinUntil(
        [&] {
          return receiver.Writers<topics::Odometry>() > 0 && receiver.Writers<topics::MapRequests>() > 0;
        },
        kPatience));
    Samples sent;
    for (int k = 0; k < count; ++k) {
      const Time stamp{std::chrono::milliseconds(20 * k)};
      const auto pose = dds::Encode<topics::Odometry>(
          dds::OdometryToIdl(stamp, RigidTransform::Identity(), {0.1 * k, 0, 0}, {0, 0, 0}));
      thalweg_msgs::msg::MapRequest request;
      request.number(static_cast<std::uint64_t>(k));
      const auto bytes = dds::Encode<topics::MapRequests>(request);
      EXPECT_TRUE(poses.Write(pose));
      EXPECT_TRUE(requests.Write(bytes));
      sent["/odometry"].push_back(pose);
      sent["/map/requests"].push_back(bytes);
      const auto written = static_cast<std::uint64_t>(2 * (k + 1));
      EXPECT_TRUE(receiver.SpinUntil([&] { return recorder.status().messages == written; }, kPatience));
    }
    recorder.Finish();
    EXPECT_EQ(recorder.status().failure, std::nullopt);
    files_ = recorder.status().files;
    return sent;
  }

  static Samples SamplesIn(const McapReader& reader) {
    Samples samples;
    MessageCursor cursor = reader.Read();
    while (const auto message = cursor.Next()) {
      samples[reader.channels().at(message->channel).topic].emplace_back(message->payload.begin(),
                                                                         message->payload.end());
    }
    return samples;
  }

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> files_;
};

TEST_F(RecorderTest, EverySampleIsRecordedByteForByteInOrder) {
  const Samples sent = Record(Options(), 20);
  const MappedFile file(folder_ / "a.mcap");
  const auto reader = McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->Check().empty());
  EXPECT_EQ(SamplesIn(*reader), sent);
  for (const auto& [number, channel] : reader->channels()) {
    EXPECT_THAT(channel.schema, testing::Not(testing::IsEmpty())) << channel.topic;
  }
}

TEST_F(RecorderTest, WhatIsReplayedIsWhatWasRecorded) {
  const Samples sent = Record(Options(), 20);
  const MappedFile file(folder_ / "a.mcap");
  const auto reader = McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  dds::Bus player_bus(BusOptionsForTest("player"));
  dds::Bus listener(BusOptionsForTest("listener"));
  Player player(*reader, {.rate = 4.0, .topics = {"odometry", "map/*"}}, player_bus);
  Samples heard;
  for (const auto& topic : {dds::InfoOf<topics::Odometry>(), dds::InfoOf<topics::MapRequests>()}) {
    listener.SubscribeBytes(topic, [&heard, name = '/' + topic.name](const dds::RawSample& sample) {
      heard[name].emplace_back(sample.bytes.begin(), sample.bytes.end());
    });
  }
  ASSERT_TRUE(player.AwaitReaders(kPatience));
  ASSERT_TRUE(listener.SpinUntil(
      [&] { return listener.Writers<topics::Odometry>() > 0 && listener.Writers<topics::MapRequests>() > 0; },
      kPatience));
  std::jthread playing([&] { player.Run({}); });
  EXPECT_TRUE(listener.SpinUntil(
      [&] { return heard["/odometry"].size() == 20 && heard["/map/requests"].size() == 20; }, kPatience));
  playing.join();
  EXPECT_EQ(heard, sent);
  EXPECT_EQ(player.status().messages, 40U);
}

TEST_F(RecorderTest, AtItsBeginningItRequestsAFullCopyOfTheMapUntilItHasOne) {
  dds::Bus mapper(BusOptionsForTest("mapper"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  const auto updates = mapper.Advertise<topics::MapUpdates>();
  dds::MapLog log(7, 0.1);
  int requests = 0;
  mapper.Subscribe<topics::MapRequests>([&](const auto& request) {
    EXPECT_TRUE(dds::FromIdl(request.header(), dds::kMapFrame));
    // The first is answered by an update only, as if the copy were lost.
    updates.Write(++requests == 1 ? log.TakeUpdate() : log.FullCopy(OccupancyGrid(0.1)));
  });
  RecorderOptions options = Options();
  options.topics = {topics::MapUpdates::kName};
  Recorder recorder(options, receiver);
  receiver.EveryWall(std::chrono::milliseconds(5), [] {});
  {
    const std::jthread mapping([&](const std::stop_token& stop) { mapper.Spin(stop); });
    ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().messages == 2; }, kPatience));
    receiver.SpinUntil([] { return false; }, 2 * dds::MapReplica::kRequestPeriod);
  }
  recorder.Finish();
  EXPECT_EQ(requests, 2) << "one that was not answered, and no more after the copy";
  const OpenRecording recording(folder_ / "a.mcap");
  const Samples samples = SamplesIn(recording.reader);
  const auto last = dds::Decode<topics::MapUpdates>(samples.at("/map/updates").back());
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->full());
}

TEST_F(RecorderTest, EachPartOfASplitRecordingHasTheLastStatesAndAFullCopyOfTheMapOfItsOwn) {
  dds::Bus mapper(BusOptionsForTest("mapper"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  const auto updates = mapper.Advertise<topics::MapUpdates>();
  const auto statuses = mapper.AdvertiseBytes(dds::InfoOf<topics::MotionStatus>());
  thalweg_msgs::msg::MotionStatus said_once;
  said_once.reason("said once");
  const auto status = dds::Encode<topics::MotionStatus>(said_once);
  statuses.Write(status);
  dds::MapLog log(7, 0.1);
  std::vector<std::string> reasons;
  mapper.Subscribe<topics::MapRequests>([&](const auto& request) {
    reasons.push_back(request.reason());
    updates.Write(log.FullCopy(OccupancyGrid(0.1)));
  });
  RecorderOptions options = Options();
  options.topics = {topics::MapUpdates::kName, topics::MotionStatus::kName};
  options.recording.split_bytes = 1;  // each message begins a file
  Recorder recorder(options, receiver);
  mapper.EveryWall(std::chrono::milliseconds(5), [] {});
  {
    const std::jthread recording([&](const std::stop_token& stop) { receiver.Spin(stop); });
    EXPECT_TRUE(
        mapper.SpinUntil([&] { return reasons.size() >= 2 && recorder.status().messages >= 3; }, kPatience));
  }
  recorder.Finish();
  ASSERT_GE(reasons.size(), 2U) << "no copy for the second file";
  EXPECT_EQ(reasons[0], "a recording begins");
  EXPECT_EQ(reasons[1], "another file of a recording begins");
  const std::vector<std::filesystem::path> files = recorder.status().files;
  const Samples last = SamplesIn(OpenRecording(files.back()).reader);
  EXPECT_THAT(last.at("/controller/status"), testing::ElementsAre(status));
}

TEST_F(RecorderTest, PartsBeginWithWhatHoldsWhichStandsOnceInTheirMerge) {
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

TEST_F(RecorderTest, ASplitRecordingAndItsMergeHoldTheSameMessages) {
  RecorderOptions options = Options();
  options.recording.split_bytes = 1;  // each file ends with its first chunk
  options.recording.compression = Compression::kNone;
  const Samples sent = Record(options, 3);
  ASSERT_FALSE(files_.empty());
  EXPECT_EQ(files_.front().filename(), "a_0.mcap");
  std::vector<std::unique_ptr<MappedFile>> files;
  std::vector<McapReader> readers;
  for (const auto& file : files_) {
    files.push_back(std::make_unique<MappedFile>(file));
    auto reader = McapReader::Open(files.back()->bytes());
    ASSERT_TRUE(reader);
    readers.push_back(*std::move(reader));
  }
  std::vector<const McapReader*> all;
  for (const McapReader& reader : readers) all.push_back(&reader);
  EXPECT_TRUE(Copy(all, {}, {.file = folder_ / "merged.mcap"}).problems.empty());
  const MappedFile merged(folder_ / "merged.mcap");
  const auto reader = McapReader::Open(merged.bytes());
  ASSERT_TRUE(reader);
  EXPECT_EQ(SamplesIn(*reader), sent);
}

TEST_F(RecorderTest, AnOldPartOfASplitRecordingIsAnErrorAtTheBeginning) {
  for (const char* const name : {"a_x.mcap", "a_.mcap", "b_3.mcap", "a_3.txt"}) std::ofstream(folder_ / name);
  RecordingOptions options = Options().recording;
  options.split_bytes = 1;
  EXPECT_NO_THROW(RecordingFile(options, {}));
  std::filesystem::remove(folder_ / "a_0.mcap");
  std::ofstream(folder_ / "a_3.mcap");
  try {
    RecordingFile(options, {});
    ADD_FAILURE() << "it would end with its fourth file";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), (folder_ / "a_3.mcap").string() + ": cannot be written: File exists");
  }
}

TEST_F(RecorderTest, ADiskThatIsNearlyFullEndsTheRecordingWhileThereIsRoomAndTheFileIsWhole) {
  RecorderOptions options = Options();
  options.recording.keep_free = 300'000'000;
  std::atomic<std::uintmax_t> available = 300'000'000;
  options.recording.available = [&](const std::filesystem::path& folder) {
    EXPECT_EQ(folder, folder_);
    return available.load();
  };
  dds::Bus sender(BusOptionsForTest("sender"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  const auto poses = sender.AdvertiseBytes(dds::InfoOf<topics::Odometry>());
  Recorder recorder(options, receiver);
  ASSERT_TRUE(sender.SpinUntil([&] { return poses.readers() > 0; }, kPatience));
  ASSERT_TRUE(receiver.SpinUntil([&] { return receiver.Writers<topics::Odometry>() > 0; }, kPatience));
  const auto bytes = dds::Encode<topics::Odometry>(nav_msgs::msg::Odometry());
  const auto empty = std::filesystem::file_size(folder_ / "a.mcap");
  receiver.EveryWall(std::chrono::milliseconds(50), [&] { poses.Write(bytes); });
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().file_bytes > empty; }, kPatience));
  EXPECT_EQ(recorder.status().failure, std::nullopt) << "just enough is free";
  available = 299'999'999;
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().failure.has_value(); }, kPatience));
  EXPECT_EQ(*recorder.status().failure,
            (folder_ / "a.mcap").string() + ": ends here, since less than 300 MB are free on its disk");
  recorder.Finish();
  const MappedFile file(folder_ / "a.mcap");
  const auto reader = McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->has_summary());
  EXPECT_TRUE(reader->Check().empty());
  EXPECT_EQ(recorder.status().file_bytes, reader->size()) << "its end is counted, too";
}

TEST_F(RecorderTest, AFullDiskEndsTheRecordingWithItsReasonAndWhatIsThereCanBeRead) {
  RecorderOptions options = Options();
  options.recording.compression = Compression::kNone;
  dds::Bus sender(BusOptionsForTest("sender"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  const auto poses = sender.AdvertiseBytes(dds::InfoOf<topics::Odometry>());
  Recorder recorder(options, receiver);
  ASSERT_TRUE(sender.SpinUntil([&] { return poses.readers() > 0; }, kPatience));
  ASSERT_TRUE(receiver.SpinUntil([&] { return receiver.Writers<topics::Odometry>() > 0; }, kPatience));
  nav_msgs::msg::Odometry message;
  message.child_frame_id(std::string(20'000, 'x'));
  const auto bytes = dds::Encode<topics::Odometry>(message);
  const FullDisk full(50'000);
  receiver.EveryWall(std::chrono::milliseconds(50), [&] { poses.Write(bytes); });
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().failure.has_value(); }, kPatience));
  EXPECT_EQ(*recorder.status().failure,
            (folder_ / "a.mcap").string() + ": cannot be written: File too large");
  recorder.Finish();
  const MappedFile file(folder_ / "a.mcap");
  const auto reader = McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->has_summary());
  EXPECT_EQ(recorder.status().file_bytes, reader->size()) << "with the part of a chunk that found room";
}

TEST_F(RecorderTest, AFolderThatDoesNotExistIsNotCreatedButNamed) {
  const std::filesystem::path file = folder_ / "mistyped" / "a.mcap";
  for (const std::uint64_t split_bytes : {0, 1}) {
    try {
      RecordingFile({.file = file, .split_bytes = split_bytes}, {});
      ADD_FAILURE() << "it was created";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(),
                file.string() + ": cannot be written: there is no folder " + (folder_ / "mistyped").string());
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "mistyped"));
  }
}

TEST_F(RecorderTest, ARecordingSplitByTimeHasAFileForEachSpanOfLogTimes) {
  const std::vector<std::uint8_t> bytes(10);
  const auto at = [](int seconds) { return Time{std::chrono::seconds(seconds)}; };
  RecordingFile file({.file = folder_ / "a.mcap", .split_after = std::chrono::seconds(10)},
                     {{.topic = "/a", .type = "nav_msgs/msg/Odometry"}});
  // A file spans less than 10 s, counted from its own first message, and a long silence is skipped.
  for (const int seconds : {100, 105, 109, 110, 119, 150}) file.Write(0, 0, at(seconds), at(seconds), bytes);
  file.Close();
  std::vector<std::vector<Time>> times;
  for (const std::filesystem::path& name : file.files()) {
    const OpenRecording part(name);
    EXPECT_TRUE(part.reader.Check().empty()) << name;
    MessageCursor cursor = part.reader.Read();
    times.emplace_back();
    while (const auto message = cursor.Next()) times.back().push_back(message->log_time);
  }
  const std::vector<std::vector<Time>> expected = {
      {at(100), at(105), at(109)}, {at(110), at(119)}, {at(150)}};
  EXPECT_EQ(times, expected);
  EXPECT_EQ(file.files().back(), folder_ / "a_2.mcap");
}

TEST_F(RecorderTest, WhatPartsSayOfTheScenarioStandsOnceInTheirMerge) {
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

TEST_F(RecorderTest, AttachmentsAreCopiedOnceAndListed) {
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

TEST_F(RecorderTest, ASpanIsCutToMilliseconds) {
  using std::chrono::microseconds;
  EXPECT_EQ(SecondsText(microseconds(12'345'999)), "12.345 s");
  EXPECT_EQ(SecondsText(microseconds(2'300'000)), "2.300 s");
  EXPECT_EQ(SecondsText(microseconds(-1'000'000)), "-1.000 s");
  EXPECT_EQ(SecondsText(Duration(0)), "0.000 s");
}

TEST_F(RecorderTest, AnExistingFileIsNotReplaced) {
  Copy({}, {}, {.file = folder_ / "a.mcap"});
  dds::Bus bus(BusOptionsForTest("recorder"));
  try {
    Recorder(Options(), bus);
    FAIL() << "the file was replaced";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), (folder_ / "a.mcap").string() + ": cannot be written: File exists");
  }
}

TEST_F(RecorderTest, ATopicBeyondTheTableIsRecordedFromWhenItIsAdded) {
  const dds::TopicInfo note{.name = "/robot/note",
                            .type_name = dds::InfoOf<topics::DepthCameraInfo>().type_name,
                            .delivery = dds::Delivery::kState,
                            .writers = dds::Writers::kMany};
  const std::string type = dds::Ros2TypeName(note.type_name);
  dds::Bus sender(BusOptionsForTest("sender"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  const auto poses = sender.AdvertiseBytes(dds::InfoOf<topics::Odometry>());
  const auto notes = sender.AdvertiseBytes(note);
  sensor_msgs::msg::CameraInfo message;
  message.distortion_model("written before it was added");
  const auto bytes = dds::Encode<topics::DepthCameraInfo>(message);
  notes.Write(bytes);
  RecorderOptions options = Options();
  options.recording.split_after = std::chrono::hours(1);
  Recorder recorder(options, receiver);
  receiver.EveryWall(std::chrono::milliseconds(5), [] {});
  ASSERT_TRUE(sender.SpinUntil([&] { return poses.readers() > 0; }, kPatience));
  const auto pose = dds::Encode<topics::Odometry>(nav_msgs::msg::Odometry());
  receiver.EveryWall(std::chrono::milliseconds(50), [&] { poses.Write(pose); });
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().messages > 0; }, kPatience));
  EXPECT_EQ(notes.readers(), 0);
  recorder.Add({note, type, std::string(dds::Ros2MsgSchema(type))});
  EXPECT_EQ(recorder.topics().back().name, note.name);
  const auto messages_before = recorder.status().messages;
  ASSERT_TRUE(receiver.SpinUntil(
      [&] { return notes.readers() > 0 && recorder.status().messages > messages_before + 2; }, kPatience));
  recorder.Finish();
  EXPECT_EQ(recorder.status().failure, std::nullopt);
  const OpenRecording recording(folder_ / "a_0.mcap");
  EXPECT_TRUE(recording.reader.Check().empty());
  EXPECT_THAT(SamplesIn(recording.reader).at("/robot/note"), testing::ElementsAre(bytes));
  for (const auto& [number, channel] : recording.reader.channels()) {
    if (channel.topic != "/robot/note") continue;
    EXPECT_EQ(channel.type, type);
    EXPECT_EQ(channel.schema, dds::Ros2MsgSchema(type));
  }
}

/// A recording of `count` empty messages of each topic, one each 20 ms.
void WriteRecording(const std::filesystem::path& name, const std::vector<dds::TopicInfo>& topics, int count) {
  std::vector<Channel> channels;
  for (const dds::TopicInfo& topic : topics) {
    channels.push_back({.topic = "/" + topic.name, .type = dds::Ros2TypeName(topic.type_name)});
  }
  RecordingFile file({.file = name}, channels);
  const std::vector<std::uint8_t> bytes(100);
  for (int k = 0; k < count; ++k) {
    const Time time{std::chrono::milliseconds(20 * k)};
    for (std::size_t topic = 0; topic < topics.size(); ++topic) {
      file.Write(topic, static_cast<std::uint32_t>(k), time, time, bytes);
    }
  }
  file.Close();
}

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

TEST_F(RecorderTest, WhatServicesWouldActOnIsReplayedOnlyWhenItIsNamed) {
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
  EXPECT_THAT(named.topics(), testing::UnorderedElementsAre(
                                  topics::PoseCommand::kName, topics::VelocityCommand::kName,
                                  topics::StampedVelocityCommand::kName, topics::OperatorCommands::kName));
}

TEST_F(RecorderTest, CommandsOfARobotWithANameAreLeftOutAsWellAndNoneHidesBehindASecondSlash) {
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

TEST_F(RecorderTest, ACopyThatFindsNoRoomLeavesNothingThatStandsInTheWayOfTheNext) {
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

TEST_F(RecorderTest, ATopicIsRenamedByItsExactNameWithOrWithoutASlash) {
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

TEST_F(RecorderTest, AStartBeyondTheEndIsRefusedWithALengthThatIsAccepted) {
  WriteRecording(folder_ / "a.mcap", {dds::InfoOf<topics::Odometry>()}, 6);
  const OpenRecording recording(folder_ / "a.mcap");
  EXPECT_EQ(RefusalOf(recording.reader, {.start = 0.2}),
            "the start must be 0 to 0.100 s, the recording's length");
  EXPECT_EQ(RefusalOf(recording.reader, {.start = 0.1}), "");
}

TEST_F(RecorderTest, APartBeginsWithWhatIsSaidOnceAndHoldsFromThenOn) {
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

TEST_F(RecorderTest, ASelectionWithoutMessagesIsRefused) {
  {
    RecordingFile file({.file = folder_ / "a.mcap"}, {{.topic = "/odometry", .type = "nav_msgs/msg/Odometry"},
                                                      {.topic = "/tf", .type = "tf2_msgs/msg/TFMessage"}});
    const std::vector<std::uint8_t> bytes(100);
    file.Write(0, 0, Time{}, Time{}, bytes);
    const Time last{std::chrono::seconds(2)};
    file.Write(1, 0, last, last, bytes);
    file.Close();
  }
  const OpenRecording recording(folder_ / "a.mcap");
  EXPECT_EQ(RefusalOf(recording.reader, {.start = 1.0, .topics = {"tf"}}), "");
  EXPECT_EQ(RefusalOf(recording.reader, {.loop = true, .start = 1.0, .topics = {"odometry"}}),
            "the topics to be played have no message that can be read from the start on");
  EXPECT_THAT(RefusalOf(recording.reader, {.loop = true, .start = 2.0}),
              testing::HasSubstr("it takes less than 10 ms"));
}

TEST_F(RecorderTest, EachLoopTakesAsLongAsTheRecording) {
  {
    RecordingFile file({.file = folder_ / "a.mcap"}, {{.topic = "/odometry", .type = "nav_msgs/msg/Odometry"},
                                                      {.topic = "/tf", .type = "tf2_msgs/msg/TFMessage"}});
    const std::vector<std::uint8_t> bytes(100);
    file.Write(0, 0, Time{}, Time{}, bytes);
    const Time last{std::chrono::milliseconds(200)};
    file.Write(1, 0, last, last, bytes);
    file.Close();
  }
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

TEST_F(RecorderTest, WithoutNamesAllTopicsAreRecordedItsOwnHealthAmongThem) {
  dds::Bus bus(BusOptionsForTest("recorder"));
  Recorder recorder({.recording = {.file = folder_ / "a.mcap"}}, bus);
  EXPECT_EQ(recorder.topics().size(), dds::AllTopics().size());
  bus.EveryWall(std::chrono::milliseconds(5), [] {});  // what is written is no event of the bus
  ASSERT_TRUE(bus.SpinUntil([&] { return recorder.status().messages > 0; }, kPatience));
  recorder.Finish();
  const OpenRecording recording(folder_ / "a.mcap");
  const Samples samples = SamplesIn(recording.reader);
  ASSERT_EQ(samples.size(), 1U);
  const auto health = dds::Decode<topics::Health>(samples.at("/health").front());
  ASSERT_TRUE(health);
  EXPECT_EQ(health->service(), "recorder");
}

/// Statuses with reasons "0", "1", ... from a publisher that waits for nobody.
class Burst {
 public:
  explicit Burst(dds::Bus& bus) : out_(bus.AdvertiseBytes(dds::InfoOf<topics::MotionStatus>())) {}
  int readers() const { return out_.readers(); }
  void Write(int count) {
    for (int k = 0; k < count; ++k) {
      thalweg_msgs::msg::MotionStatus status;
      status.reason(std::to_string(next_++));
      ASSERT_TRUE(out_.Write(dds::Encode<topics::MotionStatus>(status)));
    }
  }

 private:
  dds::Bus::BytesPublisher out_;
  int next_ = 0;
};

TEST_F(RecorderTest, ABurstOfStatesBetweenTwoTurnsIsRecordedWhole) {
  dds::Bus sender(BusOptionsForTest("sender"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  Burst burst(sender);
  Recorder recorder(Options(), receiver);
  receiver.EveryWall(std::chrono::milliseconds(5), [] {});
  ASSERT_TRUE(sender.SpinUntil([&] { return burst.readers() > 0; }, kPatience));
  ASSERT_TRUE(receiver.SpinUntil([&] { return receiver.Writers<topics::MotionStatus>() > 0; }, kPatience));
  burst.Write(90);
  EXPECT_TRUE(receiver.SpinUntil([&] { return recorder.status().messages == 90; }, kPatience));
  EXPECT_TRUE(recorder.status().lost.empty());
}

TEST_F(RecorderTest, WhatTheHistoryCannotHoldIsCountedAsLostAndReportedInItsHealth) {
  dds::Bus sender(BusOptionsForTest("sender"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  dds::Bus watcher(BusOptionsForTest("watcher"));
  Burst burst(sender);
  Recorder recorder(Options(), receiver);
  receiver.EveryWall(std::chrono::milliseconds(5), [] {});
  ASSERT_TRUE(sender.SpinUntil([&] { return burst.readers() > 0; }, kPatience));
  ASSERT_TRUE(receiver.SpinUntil([&] { return receiver.Writers<topics::MotionStatus>() > 0; }, kPatience));
  burst.Write(1);
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().messages == 1; }, kPatience));
  burst.Write(150);
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().messages == 101; }, kPatience));
  const std::map<std::string, std::uint64_t> expected = {{topics::MotionStatus::kName, 50}};
  EXPECT_EQ(recorder.status().lost, expected);

  std::uint64_t reported = 0;
  watcher.Subscribe<topics::Health>([&](const auto& health) {
    EXPECT_EQ(health.service(), "recorder");
    for (const auto& counter : health.dropped()) {
      if (counter.name() == topics::MotionStatus::kName) reported = counter.count();
    }
  });
  {
    const std::jthread recording([&](const std::stop_token& stop) { receiver.Spin(stop); });
    EXPECT_TRUE(watcher.SpinUntil([&] { return reported == 50; }, kPatience));
  }
  recorder.Finish();
  // A gap in the numbers shows where.
  const OpenRecording recording(folder_ / "a.mcap");
  MessageCursor cursor = recording.reader.Read();
  std::vector<std::uint32_t> numbers;
  while (const auto message = cursor.Next()) {
    numbers.push_back(message->sequence);
    const auto status = dds::Decode<topics::MotionStatus>(message->payload);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->reason(), std::to_string(message->sequence));
  }
  ASSERT_EQ(numbers.size(), 101U);
  EXPECT_EQ(numbers[1], 51U);
}

}  // namespace
}  // namespace thalweg::recorder
