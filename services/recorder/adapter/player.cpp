#include "services/recorder/adapter/player.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "common/base/real_time.h"
#include "common/dds/convert.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

constexpr Duration kClockPeriod = std::chrono::milliseconds(10);

/// A loop of a recording that is shorter would only keep the machine busy.
constexpr Duration kShortestLoop = std::chrono::milliseconds(10);

Time StartOf(const McapReader& reader, const PlayerOptions& options) {
  if (!reader.start()) throw std::runtime_error("the recording has no messages");
  if (!(options.rate > 0.0)) throw std::runtime_error("the rate must be above 0");
  const double length = Seconds(*reader.end() - *reader.start());
  if (!(options.start >= 0.0 && options.start <= length)) {
    throw std::runtime_error("the start must be 0 to " + std::to_string(length) +
                             " s, the recording's length");
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
    names[recorded] = played;
  }
  return names;
}

}  // namespace

Player::Player(const McapReader& reader, const PlayerOptions& options, dds::Bus& bus)
    : reader_(reader),
      options_(options),
      bus_(bus),
      start_(StartOf(reader, options)),
      playback_(start_, options.rate) {
  selection_.start = start_;
  AddOutputs();
  RequireMessages();
}

void Player::AddOutputs() {
  const auto is_wanted = [&](const std::string& topic) {
    return std::ranges::any_of(options_.topics,
                               [&](const std::string& pattern) { return Matches(pattern, topic); });
  };
  const std::map<std::string, std::string> names = NamesFrom(options_.remap, reader_);
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
    if (known != nullptr) {
      topic.delivery = known->delivery;
      topic.replay = known->replay;
    }
    if (!options_.topics.empty() && !is_wanted(recorded)) continue;
    if (channel.message_encoding != "cdr" || channel.type.empty()) {
      remarks_.push_back(recorded + " is left out: its messages are " + channel.message_encoding +
                         ", not cdr");
    } else if (known != nullptr && known->type_name != topic.type_name) {
      remarks_.push_back(recorded + " is left out: " + topic.name + " carries " +
                         dds::Ros2TypeName(known->type_name) + ", the recording has " + channel.type);
    } else if (options_.topics.empty() && topic.replay == dds::Replay::kOnlyIfNamed) {
      remarks_.push_back(recorded + " is left out, since what runs now would act on it; name it to play it");
    } else if (!AddOutput(number, topic)) {
      remarks_.push_back(recorded + " is left out: " + topic.name + " already carries another type");
    } else {
      selection_.topics.push_back(channel.topic);
    }
  }
  if (outputs_.empty()) throw std::runtime_error("the recording has none of the topics to be played");
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
    if (std::ranges::find(outputs_, message->channel, &Output::channel) != outputs_.end()) return;
  }
  throw std::runtime_error("the topics to be played have no message that can be read from the start on");
}

bool Player::AddOutput(std::uint16_t channel, const dds::TopicInfo& topic) {
  // A recording may have a channel for each publisher of a topic.
  const auto same = std::ranges::find(outputs_, topic.name, [](const Output& out) { return out.topic.name; });
  if (same != outputs_.end()) {
    if (same->topic.type_name != topic.type_name) return false;
    outputs_.push_back({channel, topic, same->publisher});
    return true;
  }
  outputs_.push_back({channel, topic, bus_.AdvertiseBytes(topic)});
  topics_.push_back(topic.name);
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

void Player::Pause() {
  const std::scoped_lock lock(mutex_);
  playback_.Pause(Steady::now());
  changed_.notify_all();
}

void Player::Resume() {
  const std::scoped_lock lock(mutex_);
  playback_.Resume(Steady::now());
  changed_.notify_all();
}

void Player::Toggle() {
  const std::scoped_lock lock(mutex_);
  playback_.running() ? playback_.Pause(Steady::now()) : playback_.Resume(Steady::now());
  changed_.notify_all();
}

void Player::Run(std::stop_token stop) {
  const RealTime on_time;
  if (!options_.paused) Resume();
  do {
    PlayOnce(stop);
    if (!options_.loop || stop.stop_requested()) break;
    const std::scoped_lock lock(mutex_);
    playback_ = PlaybackClock(start_, options_.rate);
    playback_.Resume(Steady::now());
  } while (true);
  if (status_.messages > 0) {
    status_.late_rms_ms = std::sqrt(late_square_sum_ / static_cast<double>(status_.messages));
  }
}

void Player::PlayOnce(const std::stop_token& stop) {
  constexpr std::size_t kAheadBytes = 64U << 20;
  MessageQueue ahead(kAheadBytes);
  Problems problems;
  {
    const std::jthread reading([&] {
      MessageCursor cursor = reader_.Read(selection_);
      while (const auto message = cursor.Next()) {
        const auto output = std::ranges::find(outputs_, message->channel, &Output::channel);
        if (output == outputs_.end()) continue;  // left out, of another type
        if (!ahead.Push({.topic = static_cast<std::size_t>(output - outputs_.begin()),
                         .sequence = message->sequence,
                         .log_time = message->log_time,
                         .publish_time = message->publish_time,
                         .payload = {message->payload.begin(), message->payload.end()}})) {
          break;
        }
      }
      problems = cursor.problems();
      ahead.Close();
    });
    next_clock_ = start_;
    while (!ahead.exhausted() && !stop.stop_requested()) {
      const auto message = ahead.Pop(std::chrono::milliseconds(100));
      if (!message) continue;
      if (!WaitUntil(message->log_time, stop)) break;
      Steady::time_point due;
      {
        const std::scoped_lock lock(mutex_);
        due = playback_.running() ? playback_.DueAt(message->log_time) : Steady::now();
      }
      const double late_ms = std::max(0.0, 1e3 * Seconds(Steady::now() - due));
      late_square_sum_ += late_ms * late_ms;
      status_.late_max_ms = std::max(status_.late_max_ms, late_ms);
      ++status_.messages;
      outputs_[message->topic].publisher.Write(message->payload);
    }
    ahead.Close();  // if stopped, the reading thread may wait for room
    // Each loop takes as long as the recording, however early the last of these topics ends.
    if (options_.loop) WaitUntil(*reader_.end(), stop);
  }
  status_.problems.Add(problems);
}

bool Player::WaitUntil(Time time, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (stop.stop_requested()) return false;
    const Steady::time_point now = Steady::now();
    if (!playback_.running()) {
      changed_.wait(lock, stop, [&] { return playback_.running(); });
      continue;
    }
    const bool clock_first = clock_out_ && next_clock_ <= time;
    const Steady::time_point due = playback_.DueAt(clock_first ? next_clock_ : time);
    if (now < due) {
      changed_.wait_until(lock, stop, due, [&] { return !playback_.running(); });
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
  clock_out_->Write(dds::Encode<dds::topics::Clock>(message));
}

}  // namespace thalweg::recorder
