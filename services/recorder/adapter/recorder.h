#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/dds/bus.h"
#include "services/recorder/adapter/recording_file.h"
#include "services/recorder/core/message_queue.h"

namespace thalweg::recorder {

struct RecorderOptions {
  RecordingOptions recording;
  /// Which topics of the table: names or patterns ("stereo/*"); empty = all.
  std::vector<std::string> topics = {};
  std::size_t queue_bytes = 256U << 20;    ///< [byte] Messages that wait for the disk.
  std::string map_frame = dds::kMapFrame;  ///< As it is called on the wire.
};

/// A topic that the table of topics does not have.
struct OutsideTopic {
  dds::TopicInfo info;
  std::string type;        ///< "sensor_msgs/msg/Imu"
  std::string definition;  ///< What the type is, in the format ros2msg.
};

/// Records the samples of a bus, byte for byte, in an MCAP file: log time is when a sample arrived, publish
/// time when it was written, both by system clocks. The time of the run is inside the messages.
///
/// Subscribing, a sample is only copied into a queue; a thread of its own compresses and writes. What does
/// not fit into the queue is dropped, what does not arrive is lost; both are counted, here and in the health
/// that the recorder publishes. A file that cannot be written ends the recording, and nothing else.
///
/// At the beginning of each file it requests full copies of map/updates and surface/updates, as any reader
/// does, without which a replay would have no map. The files after the first begin with what was published
/// once and holds (HeldMessages).
class Recorder {
 public:
  /// @param bus  Must not use any topic in another way: the bus's clock is the system's, and it publishes no
  ///             health of its own accord. Throws std::runtime_error for a file that cannot be created.
  Recorder(const RecorderOptions& options, dds::Bus& bus);
  ~Recorder();  ///< Ends the recording.
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Records another topic from now on. On the thread of the bus.
  void Add(const OutsideTopic& topic);

  struct Status {
    std::uint64_t messages = 0;                    ///< Written.
    std::uint64_t payload_bytes = 0;               ///< Their size.
    std::uint64_t file_bytes = 0;                  ///< On disk.
    std::map<std::string, std::uint64_t> dropped;  ///< By topic: did not fit into the queue.
    std::map<std::string, std::uint64_t> lost;     ///< By topic: written by a publisher, but did not arrive.
    std::vector<std::filesystem::path> files;
    std::optional<std::string> failure;  ///< Why the recording ended early.
  };
  Status status() const;

  /// Writes what is in the queue and the summary. Samples that arrive later are not recorded.
  void Finish();

  const std::vector<dds::TopicInfo>& topics() const { return topics_; }

 private:
  void Subscribe(std::size_t topic);
  void HoldStates(std::size_t channel, const dds::TopicInfo& topic);
  template <class Updates, class Requests>
  void RequestFullCopy(const std::string& map_frame, dds::Bus& bus);
  std::size_t file_count() const;
  void OnSample(std::size_t topic, const dds::RawSample& sample);
  void CountLost(std::size_t topic, std::uint64_t count);
  void WriteUntilClosed();
  void Write(const QueuedMessage& message);

  dds::Bus& bus_;
  std::vector<dds::TopicInfo> topics_;
  std::vector<std::uint32_t> sequences_;  ///< By topic; counts what is dropped or lost as well.
  RecordingFile file_;                    ///< Used by thread_ alone.
  MessageQueue queue_;
  mutable std::mutex mutex_;  ///< Guards the next two.
  Status status_;
  /// Those that file_ does not have yet.
  std::vector<std::pair<Channel, dds::TopicInfo>> added_;
  /// For a topic with full copies: how to recognize one, and how many files there were when the last came.
  struct FullCopies {
    bool (*is_full)(std::span<const std::uint8_t>);
    std::size_t files = 0;
  };
  std::map<std::string, FullCopies> full_copies_;  ///< By topic.
  std::thread thread_;
};

}  // namespace thalweg::recorder
