#include "services/recorder/adapter/copy.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/dds/topic_table.h"
#include "services/recorder/adapter/held_messages.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

/// A recording that is being copied, and its next message.
struct Input {
  const McapReader* recording;
  MessageCursor cursor;
  std::map<std::uint16_t, std::size_t> channels;  ///< In the copy, by number in the recording.
  std::optional<Message> next;
  std::string where;  ///< Before what is said of its problems.
};

template <class Item>
void AddUnknown(const std::vector<Item>& items, std::vector<Item>& known) {
  for (const Item& item : items) {
    if (std::ranges::find(known, item) == known.end()) known.push_back(item);
  }
}

/// Calls `hold` with the number in the copy and the topic of each channel that is in the table of topics.
template <class Hold>
void ForEachTopic(const Input& input, Hold hold) {
  for (const auto& [number, channel] : input.recording->channels()) {
    const dds::TopicInfo* const topic = dds::FindTopic(BusName(channel.topic));
    if (topic != nullptr && input.channels.contains(number)) hold(input.channels.at(number), *topic);
  }
}

/// @return How many messages were written.
std::uint64_t WriteHeldAt(Time start, const Input& input, RecordingFile& file, Problems& problems) {
  if (!input.recording->start() || start <= *input.recording->start()) return 0;
  HeldMessages held;
  Selection before{.end = start};
  ForEachTopic(input, [&](std::size_t channel, const dds::TopicInfo& topic) {
    held.Hold(channel, topic);
    if (HeldMessages::IsHeld(topic)) before.topics.push_back(topic.name);
  });
  if (before.topics.empty()) return 0;
  MessageCursor cursor = input.recording->Read(before);
  while (const auto message = cursor.Next()) {
    held.Take(input.channels.at(message->channel), message->sequence, message->log_time,
              message->publish_time, message->payload);
  }
  problems.Add(cursor.problems(), input.where);
  const std::vector<HeldMessages::Item> items = held.Items();
  for (const HeldMessages::Item& item : items) {
    file.Write(item.channel, item.sequence, start, item.publish_time, item.payload);
  }
  return items.size();
}

/// The parts of a recording repeat what holds: in their merge it stands once.
/// @return How many messages were written.
std::uint64_t Merge(std::vector<Input>& inputs, RecordingFile& file) {
  HeldMessages held;
  for (const Input& input : inputs) {
    ForEachTopic(input, [&](std::size_t channel, const dds::TopicInfo& topic) {
      const bool may_repeat = inputs.size() > 1 && topic.delivery == dds::Delivery::kState;
      if (may_repeat) held.Hold(channel, topic);
    });
  }
  std::uint64_t written = 0;
  for (;;) {
    Input* first = nullptr;
    for (Input& input : inputs) {
      if (input.next && (first == nullptr || input.next->log_time < first->next->log_time)) first = &input;
    }
    if (first == nullptr) return written;
    const Message& message = *first->next;
    const std::size_t channel = first->channels.at(message.channel);
    if (!held.Has(channel, message.sequence, message.publish_time, message.payload)) {
      file.Write(channel, message.sequence, message.log_time, message.publish_time, message.payload);
      held.Take(channel, message.sequence, message.log_time, message.publish_time, message.payload);
      ++written;
    }
    first->next = first->cursor.Next();
  }
}

}  // namespace

Copied Copy(const std::vector<const McapReader*>& recordings, const Selection& selection,
            RecordingOptions options, std::span<const std::string> names) {
  Copied copied;
  std::vector<Channel> channels;
  std::vector<Input> inputs;
  for (const McapReader* const recording : recordings) {
    const std::string where = names.empty() ? "" : names[inputs.size()] + ": ";
    copied.problems.Add(recording->problems(), where);
    Input input{.recording = recording,
                .cursor = recording->Read(selection),
                .channels = {},
                .next = std::nullopt,
                .where = where};
    for (const auto& [number, channel] : recording->channels()) {
      if (!selection.topics.empty() && !MatchesAny(selection.topics, channel.topic)) continue;
      const auto known = std::ranges::find(channels, channel);
      input.channels[number] = static_cast<std::size_t>(known - channels.begin());
      if (known == channels.end()) channels.push_back(channel);
    }
    // The parts of a recording, and most runs of a scenario, have the same.
    AddUnknown(recording->metadata(), options.metadata);
    AddUnknown(recording->attachments(), options.attachments);
    input.next = input.cursor.Next();
    inputs.push_back(std::move(input));
  }
  if (channels.empty() && !selection.topics.empty()) {
    throw std::runtime_error("there are no such topics; thalweg bag info lists those of a recording");
  }
  RecordingFile file(std::move(options), channels);
  for (const Input& input : inputs) {
    ForEachTopic(input, [&](std::size_t channel, const dds::TopicInfo& topic) { file.Hold(channel, topic); });
  }
  try {
    for (const Input& input : inputs)
      copied.messages += WriteHeldAt(selection.start, input, file, copied.problems);
    copied.messages += Merge(inputs, file);
    file.Close();
  } catch (...) {
    file.DiscardAll();
    throw;
  }
  for (const Input& input : inputs) copied.problems.Add(input.cursor.problems(), input.where);
  copied.bytes = file.bytes_written();
  copied.files = file.files();
  return copied;
}

}  // namespace thalweg::recorder
