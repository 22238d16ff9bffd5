#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "services/recorder/core/mcap_reader.h"
#include "services/recorder/core/message_queue.h"
#include "services/recorder/core/playback_clock.h"

namespace thalweg::recorder {

struct PlayerOptions {
  double rate = 1.0;   ///< Seconds of the recording per second; > 0.
  bool loop = false;   ///< Begin again at the end.
  double start = 0.0;  ///< [s] After the recording's first message.
  /// Names or patterns; empty = all but those on which services that run now would act, such as commands
  /// (dds::Replay).
  std::vector<std::string> topics = {};
  std::map<std::string, std::string> remap =
      {};               ///< Names on the bus for names in the recording; no patterns.
  bool clock = false;   ///< Publish the log time as the run's clock, 100 times a second.
  bool paused = false;  ///< Whether it waits for Resume before the first message.
};

/// Publishes the messages of a recording, byte for byte, at the pace at which they were received.
///
/// Threading: Run on one thread; Pause, Resume and Toggle on any. A thread of its own reads and decompresses
/// ahead.
class Player {
 public:
  /// @param bus  Must not use any of the topics in another way, see Bus::AdvertiseBytes. Throws
  ///             std::runtime_error for options that do not fit the recording.
  Player(const McapReader& reader, const PlayerOptions& options, dds::Bus& bus);

  /// Topics on the bus that it publishes.
  const std::vector<std::string>& topics() const { return topics_; }
  /// What was left out, and why: for people.
  const std::vector<std::string>& remarks() const { return remarks_; }

  /// Waits until each topic has a reader, at most `patience`.
  bool AwaitReaders(Duration patience);

  /// Publishes until the end, or until a stop is requested.
  void Run(std::stop_token stop);

  void Pause();
  void Resume();
  void Toggle();

  struct Status {
    std::uint64_t messages = 0;  ///< Published.
    double late_rms_ms = 0.0;    ///< [ms] Root of the mean square of their lateness.
    double late_max_ms = 0.0;    ///< [ms]
    Problems problems;           ///< What could not be read.
  };
  const Status& status() const { return status_; }  ///< After Run.

 private:
  using Steady = std::chrono::steady_clock;
  struct Output {
    std::uint16_t channel;
    dds::TopicInfo topic;
    dds::Bus::BytesPublisher publisher;
  };

  void AddOutputs();
  /// Throws if nothing is left to play, which a loop would repeat without an end.
  void RequireMessages() const;
  /// Returns false if the topic is there with another type.
  bool AddOutput(std::uint16_t channel, const dds::TopicInfo& topic);
  void PlayOnce(const std::stop_token& stop);
  /// Waits until `time` of the recording, publishing the clock meanwhile. Returns false if stopped.
  bool WaitUntil(Time time, const std::stop_token& stop);
  void PublishClock(Time time);

  const McapReader& reader_;
  PlayerOptions options_;
  dds::Bus& bus_;
  Time start_;
  std::vector<Output> outputs_;
  std::optional<dds::Bus::BytesPublisher> clock_out_;
  std::vector<std::string> topics_, remarks_;
  Selection selection_;
  Status status_;
  double late_square_sum_ = 0.0;

  std::mutex mutex_;  ///< Guards playback_.
  std::condition_variable_any changed_;
  PlaybackClock playback_;
  Time next_clock_;
};

}  // namespace thalweg::recorder
