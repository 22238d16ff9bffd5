#include "services/recorder/adapter/player.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/base/real_time.h"
#include "common/base/ros_name.h"
#include "common/base/text.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/describe.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;

constexpr Duration kClockPeriod = std::chrono::milliseconds(10);
constexpr Duration kTick = std::chrono::milliseconds(100);
constexpr Duration kLookForReaders = std::chrono::milliseconds(200);
constexpr int kTicksPerCopy = 5;       // between full copies, however many ask
constexpr int kTicksWhilePaused = 10;  // between statuses, by which tools see that the replay is there

/// A loop of a recording that is shorter would only keep the machine busy.
constexpr Duration kShortestLoop = std::chrono::milliseconds(10);

std::string RangeText(double fastest) {
  return NumberText(PlaybackClock::kSlowest) + " to " + NumberText(fastest);
}

/// The topics by which a replay is steered are its own, also if a recording has them.
bool IsOfReplay(const std::string& topic) {
  return topic == topics::ReplayCommands::kName || topic == topics::ReplayStatus::kName;
}

Time StartOf(const McapReader& reader, const PlayerOptions& options) {
  if (!reader.start()) throw std::runtime_error("the recording has no messages");
  if (!PlaybackClock::IsRate(options.rate)) {
    throw std::runtime_error("the rate is " + NumberText(options.rate) + ", must be " +
                             RangeText(PlaybackClock::kFastest));
  }
  const Duration length = *reader.end() - *reader.start();
  if (!(options.start >= 0.0 && options.start <= Seconds(length))) {
    throw std::runtime_error("the start must be 0 to " + SecondsText(length) + ", the recording's length");
  }
  const Time start = *reader.start() + FromSeconds(options.start);
  if (options.loop && Seconds(*reader.end() - start) < options.rate * Seconds(kShortestLoop)) {
    throw std::runtime_error("cannot loop: from the start to the recording's end it takes less than 10 ms");
  }
  return start;
}

/// Names on the bus for names in the recording, both without a leading slash.
std::map<std::string, std::string> NamesFrom(const std::map<std::string, std::string>& remap,
                                             const McapReader& reader) {
  std::map<std::string, std::string> names;
  for (const auto& [from, to] : remap) {
    const std::string recorded(BusName(from));
    const std::string played(BusName(to));
    if (recorded.find('*') != std::string::npos || played.empty() || played.find('*') != std::string::npos) {
      throw std::runtime_error("cannot rename " + from + " to " + to + ": both must be names, without *");
    }
    const auto is_recorded = [&](const auto& entry) { return BusName(entry.second.topic) == recorded; };
    if (std::ranges::none_of(reader.channels(), is_recorded)) {
      throw std::runtime_error("cannot rename " + from + ": the recording has no such topic");
    }
    if (!IsRosName(played)) {
      throw std::runtime_error("cannot rename " + from + ": " + to + " is not " + std::string(kRosNameRule));
    }
    names[recorded] = played;
  }
  return names;
}

/// Whether what runs now would act on a topic: on one that is played only if it is named, or on that of a
/// robot with a name, such as r2/command/pose.
bool IsActedOn(std::string_view topic) {
  for (;;) {
    const dds::TopicInfo* const known = dds::FindTopic(topic);
    if (known != nullptr && known->replay == dds::Replay::kOnlyIfNamed) return true;
    const std::size_t slash = topic.find('/');
    if (slash == std::string_view::npos) return false;
    topic.remove_prefix(slash + 1);
  }
}

}  // namespace

bool Names(const PlayerOptions& options, const std::string& topic) {
  return MatchesAny(options.topics, topic) || std::ranges::any_of(options.remap, [&](const auto& pair) {
           return Matches(pair.first, topic) || Matches(pair.second, topic);
         });
}

Player::Player(const McapReader& reader, const PlayerOptions& options, dds::Bus& bus)
    : reader_(reader),
      options_(options),
      bus_(bus),
      start_(StartOf(reader, options)),
      status_out_(bus.Advertise<topics::ReplayStatus>()),
      playback_(start_, options.rate),
      begins_paused_(options.paused),
      standing_at_(start_) {
  selection_.start = start_;
  AddOutputs();
  RequireMessages();
  Listen();
}

void Player::Listen() {
  for (const PlayedChannel& played : channels_) {
    auto follower = MakeUpdateFollower(played.topic.name);
    if (follower) followers_[played.topic.name] = std::move(follower);
  }
  bus_.Subscribe<topics::ReplayCommands>([this](const auto& command) { OnCommand(command); });
  AnswerRequests<topics::MapRequests, topics::MapUpdates>();
  AnswerRequests<topics::SurfaceRequests, topics::SurfaceUpdates>();
  bus_.EveryWall(kTick, [this] { Tick(); });
}

/// Who joins late asks the publisher of the updates for a full copy, and here that is this player.
template <class Requests, class Updates>
void Player::AnswerRequests() {
  const bool plays_requests = std::ranges::find(topics_, Requests::kName) != topics_.end();
  if (!followers_.contains(Updates::kName) || plays_requests) return;
  bus_.Subscribe<Requests>([this](const auto& request) {
    const Result<Time> stamp = dds::FromIdl(request.header(), dds::kMapFrame);
    if (!stamp) return bus_.health().Reject<Requests>(stamp.error());
    asked_for_.insert(Updates::kName);
  });
}

void Player::AddOutputs() {
  const std::map<std::string, std::string> names = NamesFrom(options_.remap, reader_);
  std::vector<std::string> acted_on;
  for (const auto& [number, channel] : reader_.channels()) {
    if (!reader_.message_counts().contains(number)) continue;
    const std::string recorded(BusName(channel.topic));
    const auto renamed = names.find(recorded);
    dds::TopicInfo topic{.name = renamed == names.end() ? recorded : renamed->second,
                         .type_name = dds::WireTypeName(channel.type),
                         .delivery = dds::Delivery::kLog,  // reliable: suits every volatile reader
                         .writers = dds::Writers::kMany,
                         .replay = dds::Replay::kByDefault};
    const dds::TopicInfo* const known = dds::FindTopic(topic.name);
    if (known != nullptr) topic.delivery = known->delivery;
    if (IsActedOn(topic.name)) topic.replay = dds::Replay::kOnlyIfNamed;
    if (!options_.topics.empty() && !MatchesAny(options_.topics, recorded)) continue;
    if (!IsRosName(topic.name)) {
      remarks_.push_back(CleanText(topic.name) + " is left out: it is not " + std::string(kRosNameRule));
      continue;
    }
    if (IsOfReplay(topic.name)) {
      remarks_.push_back(recorded + " is left out: by " + topic.name + " this replay itself is steered");
      continue;
    }
    if (channel.message_encoding != "cdr" || channel.type.empty()) {
      remarks_.push_back(recorded + " is left out: its messages are " + channel.message_encoding +
                         ", not cdr");
    } else if (known != nullptr && known->type_name != topic.type_name) {
      remarks_.push_back(recorded + " is left out: " + topic.name + " carries " +
                         dds::Ros2TypeName(known->type_name) + ", the recording has " + channel.type);
    } else if (options_.topics.empty() && topic.replay == dds::Replay::kOnlyIfNamed) {
      acted_on.push_back(recorded);
    } else if (!AddOutput(number, topic)) {
      remarks_.push_back(recorded + " is left out: " + topic.name + " already carries another type");
    } else {
      selection_.topics.push_back(channel.topic);
    }
  }
  if (!acted_on.empty()) {
    remarks_.push_back("left out, since what runs now would act on them; name them to play them: " +
                       Joined(acted_on));
  }
  if (outputs_.empty()) {
    throw std::runtime_error("the recording has none of the topics to be played" +
                             (remarks_.empty() ? "" : ": " + Joined(remarks_, "; ")));
  }
  if (!options_.clock) return;
  const dds::TopicInfo clock = dds::InfoOf<dds::topics::Clock>();
  if (std::ranges::find(topics_, clock.name) != topics_.end()) {
    throw std::runtime_error("the recording has a clock of its own: leave out the option or the topic " +
                             clock.name);
  }
  clock_out_ = bus_.AdvertiseBytes(clock);
}

void Player::RequireMessages() const {
  MessageCursor cursor = reader_.Read(selection_);
  while (const auto message = cursor.Next()) {
    if (std::ranges::find(channels_, message->channel, &PlayedChannel::channel) != channels_.end()) return;
  }
  throw std::runtime_error("the topics to be played have no message that can be read from the start on");
}

bool Player::AddOutput(std::uint16_t channel, const dds::TopicInfo& topic) {
  // A recording may have a channel for each publisher of a topic.
  const auto same =
      std::ranges::find(channels_, topic.name, [](const PlayedChannel& played) { return played.topic.name; });
  if (same != channels_.end()) {
    if (same->topic.type_name != topic.type_name) return false;
    outputs_.push_back(outputs_[static_cast<std::size_t>(same - channels_.begin())]);
  } else {
    outputs_.push_back(
        {.publisher = bus_.AdvertiseBytes(topic),
         .is_followed = MakeUpdateFollower(topic.name) != nullptr,
         .is_kept = topic.delivery == dds::Delivery::kState || topic.delivery == dds::Delivery::kDiary});
    topics_.push_back(topic.name);
  }
  channels_.push_back({channel, topic});
  return true;
}

bool Player::AwaitReaders(Duration patience) {
  const bool have_readers = bus_.SpinUntil(
      [&] {
        return std::ranges::all_of(outputs_, [](const Output& out) { return out.publisher.readers() > 0; });
      },
      patience);
  // The last readers may not have matched on their side yet, and would lose what is sent before.
  constexpr auto kMatching = std::chrono::milliseconds(200);
  bus_.SpinUntil([] { return false; }, kMatching);
  return have_readers;
}

template <class Change>
void Player::Steer(Change change) {
  {
    const std::scoped_lock lock(mutex_);
    change(Steady::now());
    ++steered_;
    changed_.notify_all();
  }
  bus_.Post([this] { PublishStatus(); });
}

void Player::Move(bool run, Steady::time_point now) {
  if (!has_begun_) {
    begins_paused_ = !run;
    return;
  }
  if (run) return playback_.Resume(now);
  KeepLateness(now);
  playback_.Pause(now);
}

void Player::Pause() {
  Steer([&](Steady::time_point now) { Move(false, now); });
}

void Player::Resume() {
  Steer([&](Steady::time_point now) { Move(true, now); });
}

void Player::Toggle() {
  Steer([&](Steady::time_point now) { Move(paused(), now); });
}

void Player::Begin() {
  Steer([&](Steady::time_point now) {
    has_begun_ = true;
    if (!begins_paused_) playback_.Resume(now);
  });
}

void Player::Seek(Time time) {
  Steer([&, to = std::clamp(time, *reader_.start(), *reader_.end())](Steady::time_point now) {
    playback_.Seek(now, to);
    seek_to_ = standing_at_ = to;
    awaited_.reset();
    late_before_ = Duration(0);
  });
}

void Player::SetRate(double rate) {
  Steer([&, to = std::clamp(rate, PlaybackClock::kSlowest, FastestRate())](Steady::time_point now) {
    KeepLateness(now);
    playback_.SetRate(now, to);
  });
}

void Player::KeepLateness(Steady::time_point now) {
  if (!awaited_ || !playback_.running()) return;
  late_before_ += std::max(Duration(0), Duration(now - playback_.DueAt(*awaited_)));
}

double Player::FastestRate() const {
  if (!options_.loop) return PlaybackClock::kFastest;
  return std::min(PlaybackClock::kFastest, Seconds(*reader_.end() - start_) / Seconds(kShortestLoop));
}

std::string Player::RateRange() const {
  const double fastest = FastestRate();
  return RangeText(fastest) +
         (fastest < PlaybackClock::kFastest ? ", since a loop takes at least 10 ms" : "");
}

Player::Progress Player::progress() const {
  const std::scoped_lock lock(mutex_);
  const Time begin = *reader_.start();
  const Time end = *reader_.end();
  const Time now = standing_at_.value_or(playback_.At(Steady::now()));
  return {begin, end, std::clamp(now, begin, end), playback_.rate(), paused()};
}

bool Player::paused() const {
  return has_begun_ ? !playback_.running() : begins_paused_;
}

void Player::Run(const std::stop_token& stop) {
  std::exception_ptr failure;
  std::stop_source ended;
  {
    const std::stop_callback pass_on(stop, [&] { ended.request_stop(); });
    const std::jthread spinning([&](const std::stop_token& own) {
      try {
        bus_.Spin(own);
      } catch (...) {  // for the caller
        failure = std::current_exception();
        ended.request_stop();
      }
    });
    const RealTime on_time;
    Begin();
    Play(ended.get_token());
    Pause();
  }
  PublishStatus();
  if (status_.messages > 0) {
    status_.late_rms_ms = std::sqrt(late_square_sum_ / static_cast<double>(status_.messages));
  }
  if (failure) std::rethrow_exception(failure);
}

void Player::Play(const std::stop_token& stop) {
  Time from = start_;
  bool jumps = start_ > *reader_.start();
  while (!stop.stop_requested()) {
    if (const auto seek = TakeSeek()) {
      from = *seek;
      jumps = true;
    }
    if (jumps && !Restore(from, stop)) continue;
    PlayFrom(from, stop);
    if (stop.stop_requested() || seeks()) continue;
    if (!options_.loop && !options_.stay) return;
    if (!options_.loop) AwaitSteering(stop);
    if (!seeks()) Seek(start_);
  }
}

std::optional<Time> Player::TakeSeek() {
  const std::scoped_lock lock(mutex_);
  if (seek_to_) token_ = dds::MapLog::MakeSession();
  return std::exchange(seek_to_, std::nullopt);
}

bool Player::seeks() const {
  const std::scoped_lock lock(mutex_);
  return seek_to_.has_value();
}

bool Player::Restore(Time time, const std::stop_token& stop) {
  std::optional<Moment> moment;
  // At the usual priority, since this may take long and nothing can be late meanwhile.
  std::thread([&] {
    // While it plays, what comes at once need not come twice.
    const Duration soon = progress().paused ? Duration(0) : Duration(std::chrono::seconds(1));
    moment =
        ReadMoment(reader_, channels_, time, token_, soon, [&] { return stop.stop_requested() || seeks(); });
  }).join();
  if (!moment) return false;
  status_.problems.Add(moment->problems);
  for (Moment::Item& item : moment->items) {
    outputs_[item.channel].publisher.Write(item.sample);
    outputs_[item.channel].last = std::move(item.sample);
  }
  if (clock_out_) PublishClock(time);
  bus_.Post([this, token = token_.load(), its = std::make_shared<Followers>(std::move(moment->followers))] {
    followers_ = std::move(*its);
    followers_token_ = token;
  });
  return true;
}

void Player::ReadAhead(Time from, MessageQueue& ahead, Problems& problems) const {
  Selection selection = selection_;
  selection.start = from;
  const std::uint64_t token = token_;
  MessageCursor cursor = reader_.Read(selection);
  while (const auto message = cursor.Next()) {
    const auto played = std::ranges::find(channels_, message->channel, &PlayedChannel::channel);
    if (played == channels_.end()) continue;  // left out, of another type
    const auto index = static_cast<std::size_t>(played - channels_.begin());
    QueuedMessage queued{.topic = index,
                         .sequence = message->sequence,
                         .log_time = message->log_time,
                         .publish_time = message->publish_time,
                         .payload = {message->payload.begin(), message->payload.end()}};
    if (token != 0 && outputs_[index].is_followed) {
      queued.payload = MakeUpdateFollower(played->topic.name)->Renamed(queued.payload, token);
    }
    if (!ahead.Push(std::move(queued))) break;
  }
  problems = cursor.problems();
  ahead.Close();
}

void Player::PlayFrom(Time from, const std::stop_token& stop) {
  constexpr std::size_t kAheadBytes = 64U << 20;
  MessageQueue ahead(kAheadBytes);
  Problems problems;
  {
    const std::jthread reading([&] { ReadAhead(from, ahead, problems); });
    next_clock_ = from;
    while (!ahead.exhausted() && !stop.stop_requested() && !seeks()) {
      auto message = ahead.Pop(std::chrono::milliseconds(100));
      if (!message) continue;
      Go(message->log_time);
      if (!WaitUntil(message->log_time, stop)) break;
      PublishDue(*std::move(message));
    }
    ahead.Close();  // if stopped, the reading thread may wait for room
    Go(std::nullopt);
    // Each loop takes as long as the recording, however early the last of these topics ends.
    if (options_.loop || options_.stay) WaitUntil(*reader_.end(), stop);
  }
  status_.problems.Add(problems);
}

void Player::Go(std::optional<Time> next) {
  const std::scoped_lock lock(mutex_);
  if (seek_to_) return;
  awaited_ = next;
  if (!standing_at_) return;
  playback_.Seek(Steady::now(), *standing_at_);
  playback_.SetNext(*standing_at_);  // until WaitUntil knows more
  standing_at_.reset();
}

void Player::PublishDue(QueuedMessage message) {
  double late_ms = 0.0;
  {
    const std::scoped_lock lock(mutex_);
    KeepLateness(Steady::now());
    late_ms = 1e3 * Seconds(std::exchange(late_before_, Duration(0)));
    awaited_.reset();
  }
  late_square_sum_ += late_ms * late_ms;
  status_.late_max_ms = std::max(status_.late_max_ms, late_ms);
  ++status_.messages;
  Output& output = outputs_[message.topic];
  output.publisher.Write(message.payload);
  if (!output.is_followed) {
    output.last = std::move(message.payload);
    return;
  }
  bus_.Post([this, token = token_.load(), channel = message.topic, sample = std::move(message.payload)] {
    if (token == followers_token_) followers_.at(channels_[channel].topic.name)->Follow(sample);
  });
}

void Player::AwaitSteering(const std::stop_token& stop) {
  Steer([&](Steady::time_point now) {
    playback_.Pause(now);
    playback_.Seek(now, *reader_.end());
  });
  std::unique_lock lock(mutex_);
  while (!playback_.running() && !seek_to_ && !stop.stop_requested()) StandStill(lock, stop);
}

void Player::StandStill(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
  for (Output& output : outputs_) {
    output.readers = output.publisher.readers();
    output.has_new_reader = false;
  }
  const auto is_steered = [&, before = steered_] { return steered_ != before; };
  while (!changed_.wait_for(lock, stop, kLookForReaders, is_steered) && !stop.stop_requested()) {
    for (Output& output : outputs_) {
      if (output.is_kept || output.is_followed) continue;
      // One turn later, since a reader that has just come may not hear yet.
      if (std::exchange(output.has_new_reader, false) && !output.last.empty())
        output.publisher.Write(output.last);
      const int readers = output.publisher.readers();
      output.has_new_reader = readers > std::exchange(output.readers, readers);
    }
  }
}

bool Player::WaitUntil(Time time, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (stop.stop_requested() || seek_to_) return false;
    const auto is_steered = [&, before = steered_] { return steered_ != before; };
    const bool clock_first = clock_out_ && next_clock_ <= time;
    playback_.SetNext(clock_first ? next_clock_ : time);
    const Steady::time_point now = Steady::now();
    if (!playback_.running()) {
      StandStill(lock, stop);
      continue;
    }
    const Steady::time_point due = playback_.DueAt(clock_first ? next_clock_ : time);
    if (now < due) {
      changed_.wait_until(lock, stop, due, is_steered);
      continue;
    }
    if (!clock_first) return true;
    PublishClock(next_clock_);
    next_clock_ += kClockPeriod;
  }
}

void Player::PublishClock(Time time) {
  rosgraph_msgs::msg::Clock message;
  message.clock(dds::ToIdl(time));
  clock_out_->Write(dds::Encode<topics::Clock>(message));
}

std::optional<std::string> Player::WhyRefused(const thalweg_msgs::msg::ReplayCommand& command) const {
  constexpr std::size_t kLongestSender = 64;
  const std::string& sender = command.sender();
  if (sender.size() > kLongestSender || dds::SenderName(sender) != sender) {
    return "the sender must be at most 64 characters of printable ASCII";
  }
  switch (command.kind()) {
    case thalweg_msgs::msg::REPLAY_PAUSE:
    case thalweg_msgs::msg::REPLAY_RESUME:
      return std::nullopt;
    case thalweg_msgs::msg::REPLAY_SEEK: {
      const Result<Time> time = dds::FromIdl(command.time());
      if (!time) return "time: " + time.error();
      // Either end, computed in double precision from times since 1970, lies a little beyond.
      constexpr Duration kRounding = std::chrono::milliseconds(1);
      if (*time >= *reader_.start() - kRounding && *time <= *reader_.end() + kRounding) return std::nullopt;
      return "the time is " + SecondsText(*time - *reader_.start()) +
             " after the recording's beginning, must be 0 to " +
             SecondsText(*reader_.end() - *reader_.start());
    }
    case thalweg_msgs::msg::REPLAY_RATE:
      if (PlaybackClock::IsRate(command.rate()) && command.rate() <= FastestRate()) return std::nullopt;
      return "the rate is " + NumberText(command.rate()) + ", must be " + RateRange();
  }
  return "there is no command of kind " + std::to_string(static_cast<std::uint32_t>(command.kind()));
}

void Player::OnCommand(const thalweg_msgs::msg::ReplayCommand& command) {
  const std::string sender = command.sender().empty() ? "somebody" : dds::SenderName(command.sender());
  if (const auto reason = WhyRefused(command)) {
    last_refusal_ = *reason;
    bus_.health().Reject<topics::ReplayCommands>(sender + ": " + *reason);
    return PublishStatus();
  }
  last_refusal_.clear();
  switch (command.kind()) {
    case thalweg_msgs::msg::REPLAY_PAUSE:
      spdlog::info("{}: pause", sender);
      return Pause();
    case thalweg_msgs::msg::REPLAY_RESUME:
      spdlog::info("{}: resume", sender);
      return Resume();
    case thalweg_msgs::msg::REPLAY_SEEK: {
      const Time time = *dds::FromIdl(command.time());
      spdlog::info("{}: seek to {}", sender, SecondsText(time - *reader_.start()));
      return Seek(time);
    }
    case thalweg_msgs::msg::REPLAY_RATE:
      spdlog::info("{}: rate {}", sender, NumberText(command.rate()));
      return SetRate(command.rate());
  }
}

void Player::Tick() {
  ++ticks_;
  if (!progress().paused || ticks_ % kTicksWhilePaused == 0) PublishStatus();
  // After a seek, until its followers are here, a copy would be of another time.
  if (ticks_ % kTicksPerCopy != 0 || followers_token_ != token_) return;
  for (const std::string& topic : std::exchange(asked_for_, {})) {
    const auto copy = followers_.at(topic)->FullCopy();
    const auto channel =
        std::ranges::find(channels_, topic, [](const PlayedChannel& played) { return played.topic.name; });
    if (copy) outputs_[static_cast<std::size_t>(channel - channels_.begin())].publisher.Write(*copy);
  }
}

void Player::PublishStatus() {
  const Progress its = progress();
  thalweg_msgs::msg::ReplayStatus status;
  status.header(dds::MakeHeader(Time(), dds::kMapFrame));
  status.file(options_.name);
  status.begin(dds::ToIdl(its.begin));
  status.end(dds::ToIdl(its.end));
  status.now(dds::ToIdl(its.now));
  status.rate(its.rate);
  status.paused(its.paused);
  status.loop(options_.loop);
  status.last_refusal(last_refusal_);
  status_out_.Write(status);
}

}  // namespace thalweg::recorder
