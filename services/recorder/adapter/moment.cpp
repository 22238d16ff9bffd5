#include "services/recorder/adapter/moment.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <set>
#include <utility>

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;

constexpr std::size_t kDiaryLines = 100;  // as Delivery::kDiary keeps

/// What a reader must have of a topic.
enum class Need { kNothing, kUpdates, kLines, kTransforms, kNewest };

Need NeedOf(const dds::TopicInfo& topic) {
  const bool is_state = topic.delivery == dds::Delivery::kState;
  if (topic.replay == dds::Replay::kOnlyIfNamed && !is_state) return Need::kNothing;
  if (topic.delivery == dds::Delivery::kCommand) return Need::kNothing;
  if (topic.delivery == dds::Delivery::kDiary) return Need::kLines;
  if (topic.type_name == dds::InfoOf<topics::Transforms>().type_name) return Need::kTransforms;
  return MakeUpdateFollower(topic.name) == nullptr ? Need::kNewest : Need::kUpdates;
}

/// Whether all messages from the beginning count, or the last one only.
bool NeedsAll(const dds::TopicInfo& topic) {
  switch (NeedOf(topic)) {
    case Need::kUpdates:
    case Need::kLines:
      return true;
    case Need::kTransforms:
      return topic.delivery == dds::Delivery::kState;  // static ones are said once
    default:
      return false;
  }
}

/// Takes in the messages before some time.
class MomentReader {
 public:
  MomentReader(const McapReader& reader, const std::vector<PlayedChannel>& channels, std::uint64_t token)
      : reader_(reader), channels_(channels), token_(token) {
    for (const auto& [channel, topic] : channels) {
      if (NeedOf(topic) == Need::kUpdates && !moment_.followers.contains(topic.name))
        moment_.followers[topic.name] = MakeUpdateFollower(topic.name);
    }
  }

  /// Reads the messages of a span of time on the topics for which `is_wanted`. Returns false if canceled.
  bool Read(Time start, Time end, const std::function<bool(std::size_t)>& is_wanted,
            const std::function<bool()>& canceled) {
    Selection selection{.start = start, .end = end};
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      if (is_wanted(k)) selection.topics.push_back(reader_.channels().at(channels_[k].channel).topic);
    }
    if (selection.topics.empty()) return true;
    MessageCursor cursor = reader_.Read(selection);
    while (const auto message = cursor.Next()) {
      if (canceled()) return false;
      const auto channel = std::ranges::find(channels_, message->channel, &PlayedChannel::channel);
      const auto index = static_cast<std::size_t>(channel - channels_.begin());
      if (channel != channels_.end() && is_wanted(index)) Take(index, *message);
    }
    moment_.problems.Add(cursor.problems());
    return true;
  }

  /// Reads the first message after `time` of each topic for which `is_missing`, but for those that come
  /// within `soon`. Returns false if canceled.
  bool ReadFirst(Time time, Duration soon, const std::function<bool(std::size_t)>& is_missing,
                 const std::function<bool()>& canceled) {
    Selection selection{.start = time};
    std::size_t missing = 0;
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      if (!is_missing(k) || !reader_.message_counts().contains(channels_[k].channel)) continue;
      selection.topics.push_back(reader_.channels().at(channels_[k].channel).topic);
      ++missing;
    }
    if (missing == 0) return true;
    std::set<std::size_t> first;
    MessageCursor cursor = reader_.Read(selection);
    for (auto message = cursor.Next(); message && missing > 0; message = cursor.Next()) {
      if (canceled()) return false;
      const auto channel = std::ranges::find(channels_, message->channel, &PlayedChannel::channel);
      const auto index = static_cast<std::size_t>(channel - channels_.begin());
      if (channel == channels_.end() || !is_missing(index) || !first.insert(index).second) continue;
      if (message->log_time >= time + soon) Take(index, *message);
      --missing;
    }
    moment_.problems.Add(cursor.problems());
    return true;
  }

  bool has(std::size_t channel) const { return found_.contains(channel); }

  Moment Finish() {
    for (const auto& [channel, lines] : lines_) {
      for (const Stored& line : lines) stored_.push_back({line.time, channel, line.sample});
    }
    for (auto& [channel, transforms] : transforms_) {
      tf2_msgs::msg::TFMessage message;
      for (auto& [frame, transform] : transforms.by_frame) message.transforms().push_back(transform);
      stored_.push_back({transforms.time, channel, dds::Encode<topics::Transforms>(message)});
    }
    for (auto& [channel, newest] : newest_) stored_.push_back({newest.time, channel, newest.sample});
    std::ranges::stable_sort(stored_, {}, &Stored::time);
    for (auto& [topic, follower] : moment_.followers) AddFullCopy(topic, *follower);
    for (Stored& stored : stored_) moment_.items.push_back({stored.channel, std::move(stored.sample)});
    return std::move(moment_);
  }

 private:
  struct Stored {
    Time time;
    std::size_t channel = 0;
    std::vector<std::uint8_t> sample = {};
  };
  struct Transforms {
    Time time;
    std::map<std::string, geometry_msgs::msg::TransformStamped> by_frame;
  };

  void Take(std::size_t channel, const Message& message) {
    found_.insert(channel);
    switch (NeedOf(channels_[channel].topic)) {
      case Need::kNothing:
        return;
      case Need::kUpdates:
        return moment_.followers.at(channels_[channel].topic.name)->Follow(message.payload, token_);
      case Need::kLines: {
        auto& lines = lines_[channel];
        lines.push_back({message.log_time, channel, {message.payload.begin(), message.payload.end()}});
        if (lines.size() > kDiaryLines) lines.pop_front();
        return;
      }
      case Need::kTransforms: {
        const auto said = dds::Decode<topics::Transforms>(message.payload);
        if (!said) return;
        Transforms& its = transforms_[channel];
        its.time = message.log_time;
        for (const auto& transform : said->transforms()) its.by_frame[transform.child_frame_id()] = transform;
        return;
      }
      case Need::kNewest: {
        Stored& newest = newest_[channel];
        newest.time = message.log_time;
        newest.sample.assign(message.payload.begin(), message.payload.end());
        return;
      }
    }
  }

  void AddFullCopy(const std::string& topic, const UpdateFollower& follower) {
    const auto channel =
        std::ranges::find(channels_, topic, [](const PlayedChannel& played) { return played.topic.name; });
    std::optional<UpdateFollower::Sample> copy = follower.FullCopy();
    if (!copy && token_ != 0) {
      MessageCursor cursor = reader_.Read({.topics = {reader_.channels().at(channel->channel).topic}});
      if (const auto first = cursor.Next()) copy = follower.Nothing(first->payload, token_);
    }
    if (copy) moment_.items.push_back({static_cast<std::size_t>(channel - channels_.begin()), *copy});
  }

  const McapReader& reader_;
  const std::vector<PlayedChannel>& channels_;
  std::uint64_t token_;
  Moment moment_;
  std::set<std::size_t> found_;                      ///< Channels of which a message was read.
  std::map<std::size_t, std::deque<Stored>> lines_;  ///< These by channel.
  std::map<std::size_t, Transforms> transforms_;
  std::map<std::size_t, Stored> newest_;
  std::vector<Stored> stored_;
};

}  // namespace

std::optional<Moment> ReadMoment(const McapReader& reader, const std::vector<PlayedChannel>& channels,
                                 Time time, std::uint64_t token, Duration soon,
                                 const std::function<bool()>& canceled) {
  MomentReader moment(reader, channels, token);
  const auto needs_all = [&](std::size_t k) { return NeedsAll(channels[k].topic); };
  if (!moment.Read(Time::min(), time, needs_all, canceled)) return std::nullopt;
  // Most topics have a message in the last second, so that little has to be read for them.
  const auto is_missing = [&](std::size_t k) {
    return !needs_all(k) && NeedOf(channels[k].topic) != Need::kNothing && !moment.has(k);
  };
  Time end = time;
  for (const Time start : {time - 1s, time - 10s, time - 100s, Time::min()}) {
    std::vector<bool> missing(channels.size());
    for (std::size_t k = 0; k < channels.size(); ++k) missing[k] = is_missing(k);
    if (!moment.Read(
            start, end, [&](std::size_t k) { return missing[k]; }, canceled))
      return std::nullopt;
    end = start;
  }
  if (token != 0 && !moment.ReadFirst(time, soon, is_missing, canceled)) return std::nullopt;
  return moment.Finish();
}

}  // namespace thalweg::recorder
