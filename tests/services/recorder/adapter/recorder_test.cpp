#include "services/recorder/adapter/recorder.h"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/copy.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"
#include "tests/services/recorder/support/recordings.h"
#include "tests/support/full_disk.h"
#include "tests/support/test_bus.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using test::OpenRecording;
using test::Samples;
using test::SamplesIn;
using thalweg::test::BusOptionsForTest;
using thalweg::test::FullDisk;
using thalweg::test::kPatience;

class RecorderTest : public test::ScratchFolder {
 protected:
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

TEST_F(RecorderTest, ADiskThatIsNearlyFullAtTheBeginningEndsTheRecordingAtItsFirstMessage) {
  RecorderOptions options = Options();
  options.recording.available = [](const std::filesystem::path&) { return 0; };
  dds::Bus sender(BusOptionsForTest("sender"));
  dds::Bus receiver(BusOptionsForTest("recorder"));
  const auto poses = sender.AdvertiseBytes(dds::InfoOf<topics::Odometry>());
  Recorder recorder(options, receiver);
  ASSERT_TRUE(sender.SpinUntil([&] { return poses.readers() > 0; }, kPatience));
  ASSERT_TRUE(receiver.SpinUntil([&] { return receiver.Writers<topics::Odometry>() > 0; }, kPatience));
  const auto bytes = dds::Encode<topics::Odometry>(nav_msgs::msg::Odometry());
  poses.Write(bytes);
  ASSERT_TRUE(receiver.SpinUntil([&] { return recorder.status().failure.has_value(); }, kPatience));
  EXPECT_EQ(recorder.status().messages, 1U);
  recorder.Finish();
  const MappedFile file(folder_ / "a.mcap");
  const auto reader = McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->Check().empty());
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
