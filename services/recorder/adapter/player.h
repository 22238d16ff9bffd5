#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "services/recorder/adapter/moment.h"
#include "services/recorder/adapter/update_follower.h"
#include "services/recorder/core/mcap_reader.h"
#include "services/recorder/core/message_queue.h"
#include "services/recorder/core/playback_clock.h"

namespace thalweg::recorder {

struct PlayerOptions {
  std::string name = {};  ///< The recording's, for people.
  double rate = 1.0;      ///< Seconds of the recording per second; see PlaybackClock::IsRate.
  bool loop = false;      ///< Begin again at the end.
  bool stay = false;      ///< Pause at the end, to be steered from there, instead of ending.
  double start = 0.0;     ///< [s] After the recording's first message.
  /// Names or patterns; empty = all but those on which services that run now would act, such as commands
  /// (dds::Replay).
  std::vector<std::string> topics = {};
  std::map<std::string, std::string> remap =
      {};               ///< Names on the bus for names in the recording; no patterns.
  bool clock = false;   ///< Publish the log time as the run's clock, 100 times a second.
  bool paused = false;  ///< Whether it waits for Resume before the first message.
};

/// Whether the options name a topic, as one to play, to rename or to play another as.
bool Names(const PlayerOptions& options, const std::string& topic);

/// Publishes the messages of a recording, byte for byte, at the pace at which they were received. Anybody on
/// the bus may steer it by replay/command; replay/status says where it is.
///
/// After a seek, and where a loop begins, readers are given what they would hold there (moment.h), and
/// map/updates and surface/updates go on under other sessions, so that no reader takes an earlier map for an
/// old message. Up to then no payload is touched. Whoever asks for a full copy of these topics gets one, and
/// a reader that comes while it is paused gets the last sample of every topic.
///
/// Threading: Run on one thread, which spins the bus on another; Pause, Resume, Toggle, Seek, SetRate and
/// progress on any. A thread of its own reads and decompresses ahead.
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

  /// Publishes until the end, or until a stop is requested. Passes on what handlers of the bus throw.
  void Run(const std::stop_token& stop);

  void Pause();
  void Resume();  ///< At the end, from the beginning on.
  void Toggle();
  void Seek(Time time);       ///< To the nearest time of the recording.
  void SetRate(double rate);  ///< To the nearest rate that PlaybackClock takes and a loop allows.

  struct Progress {
    Time begin, end, now;  ///< Log times; all before `now` is published.
    double rate = 1.0;
    bool paused = false;  ///< Before Run has begun: whether it begins paused.
  };
  Progress progress() const;

  struct Status {
    std::uint64_t messages = 0;  ///< Published, without those that follow a seek at once.
    double late_rms_ms = 0.0;    ///< [ms] Root of the mean square of their lateness.
    double late_max_ms = 0.0;    ///< [ms]
    Problems problems;           ///< What could not be read.
  };
  const Status& status() const { return status_; }  ///< After Run.

 private:
  using Steady = std::chrono::steady_clock;
  using Followers = std::map<std::string, std::unique_ptr<UpdateFollower>>;
  struct Output {
    dds::Bus::BytesPublisher publisher;
    bool is_followed = false;  ///< It carries numbered updates.
    bool is_kept = false;      ///< The middleware keeps the last sample for who joins late.
    std::vector<std::uint8_t> last = {};
    int readers = 0;  ///< While paused.
    bool has_new_reader = false;
  };

  void AddOutputs();
  /// Throws if nothing is left to play, which a loop would repeat without an end.
  void RequireMessages() const;
  /// Returns false if the topic is there with another type.
  bool AddOutput(std::uint16_t channel, const dds::TopicInfo& topic);
  void Listen();

  // On the thread of Run.
  void Play(const std::stop_token& stop);
  /// Sends what readers must hold at `time`. Returns false if stopped, or if another seek came.
  bool Restore(Time time, const std::stop_token& stop);
  /// Plays up to the end of the recording, unless stopped or sought before.
  void PlayFrom(Time from, const std::stop_token& stop);
  void ReadAhead(Time from, MessageQueue& ahead, Problems& problems) const;
  void PublishDue(QueuedMessage message);
  /// Lets the time pass from where readers have their state.
  /// @param next  Log time of the message that is published next; nothing at the end.
  void Go(std::optional<Time> next);
  /// Waits until `time` of the recording, publishing the clock meanwhile. Returns false if stopped or sought.
  bool WaitUntil(Time time, const std::stop_token& stop);
  void AwaitSteering(const std::stop_token& stop);
  /// Waits until somebody steers, and gives the last samples to readers that come meanwhile.
  void StandStill(std::unique_lock<std::mutex>& lock, const std::stop_token& stop);
  void PublishClock(Time time);
  std::optional<Time> TakeSeek();
  bool seeks() const;

  // On the thread that spins the bus.
  void OnCommand(const thalweg_msgs::msg::ReplayCommand& command);
  std::optional<std::string> WhyRefused(const thalweg_msgs::msg::ReplayCommand& command) const;
  template <class Requests, class Updates>
  void AnswerRequests();
  void Tick();
  void PublishStatus();

  /// As a loop allows it, which takes some time however fast it is.
  double FastestRate() const;
  std::string RateRange() const;
  /// Before a pause or another rate, from which on nothing is late: keeps how late the next message is.
  void KeepLateness(Steady::time_point now);
  /// What Progress says; the caller holds mutex_.
  bool paused() const;
  /// Lets time pass, or not; before Run has begun, from its beginning on.
  void Move(bool run, Steady::time_point now);
  void Begin();
  /// Wakes the thread of Run and says what is new.
  template <class Change>
  void Steer(Change change);

  const McapReader& reader_;
  PlayerOptions options_;
  dds::Bus& bus_;
  Time start_;
  std::vector<PlayedChannel> channels_;
  std::vector<Output> outputs_;  ///< In the order of channels_.
  std::optional<dds::Bus::BytesPublisher> clock_out_;
  dds::Bus::Publisher<dds::topics::ReplayStatus> status_out_;
  std::vector<std::string> topics_, remarks_;
  Selection selection_;
  Status status_;
  double late_square_sum_ = 0.0;
  Time next_clock_;

  mutable std::mutex mutex_;  ///< Guards the next nine.
  std::condition_variable_any changed_;
  PlaybackClock playback_;
  bool has_begun_ = false;  ///< Whether Run has.
  bool begins_paused_;
  std::optional<Time> seek_to_;      ///< A seek that the thread of Run has yet to see.
  std::optional<Time> standing_at_;  ///< While readers are being given their state, no time passes.
  std::uint64_t steered_ = 0;        ///< Counts changes.
  std::optional<Time> awaited_;      ///< Log time of the message that is published next, once it is read.
  Duration late_before_{0};          ///< How late that was already when it was steered.

  std::atomic<std::uint64_t> token_ = 0;  ///< Renames sessions; changes with each seek.

  // What the thread that spins the bus uses.
  Followers followers_;
  std::uint64_t followers_token_ = 0;
  std::set<std::string> asked_for_;  ///< Topics of which somebody has asked for a full copy.
  int ticks_ = 0;
  std::string last_refusal_;
};

}  // namespace thalweg::recorder
