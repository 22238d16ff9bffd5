#include "services/recorder/adapter/copy.h"

#include <algorithm>
#include <map>
#include <utility>

#include "common/dds/topic_table.h"
#include "services/recorder/adapter/moment.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

/// A recording that is being copied, and its next message.
struct Input {
  const McapReader* recording;
  MessageCursor cursor;
  std::map<std::uint16_t, std::size_t> channels;  ///< In the copy, by number in the recording.
  std::optional<Message> next;
};

/// The copied topics of which a reader that joins late is given what was said before.
std::vector<PlayedChannel> HeldChannels(const Input& input) {
  std::vector<PlayedChannel> held;
  for (const auto& [number, channel] : input.recording->channels()) {
    const dds::TopicInfo* const topic = dds::FindTopic(BusName(channel.topic));
    if (topic == nullptr || !input.channels.contains(number)) continue;
    if (topic->delivery == dds::Delivery::kState || MakeUpdateFollower(topic->name) != nullptr)
      held.push_back({number, *topic});
  }
  return held;
}

void WriteHeldAt(Time start, const Input& input, RecordingFile& file, Problems& problems) {
  if (!input.recording->start() || start <= *input.recording->start()) return;
  const std::vector<PlayedChannel> held = HeldChannels(input);
  const auto moment = ReadMoment(*input.recording, held, start, 0, [] { return false; });
  problems.Add(moment->problems);
  for (const Moment::Item& item : moment->items) {
    file.Write(input.channels.at(held[item.channel].channel), 0, start, start, item.sample);
  }
}

void Merge(std::vector<Input>& inputs, RecordingFile& file) {
  for (;;) {
    Input* first = nullptr;
    for (Input& input : inputs) {
      if (input.next && (first == nullptr || input.next->log_time < first->next->log_time)) first = &input;
    }
    if (first == nullptr) return;
    const Message& message = *first->next;
    file.Write(first->channels.at(message.channel), message.sequence, message.log_time, message.publish_time,
               message.payload);
    first->next = first->cursor.Next();
  }
}

}  // namespace

Problems Copy(const std::vector<const McapReader*>& recordings, const Selection& selection,
              RecordingOptions options) {
  Problems problems;
  std::vector<Channel> channels;
  std::vector<Input> inputs;
  for (const McapReader* const recording : recordings) {
    problems.Add(recording->problems());
    Input input{
        .recording = recording, .cursor = recording->Read(selection), .channels = {}, .next = std::nullopt};
    for (const auto& [number, channel] : recording->channels()) {
      if (!selection.topics.empty() && !MatchesAny(selection.topics, channel.topic)) continue;
      const auto known = std::ranges::find(channels, channel);
      input.channels[number] = static_cast<std::size_t>(known - channels.begin());
      if (known == channels.end()) channels.push_back(channel);
    }
    for (const Metadata& metadata : recording->metadata()) options.metadata.push_back(metadata);
    input.next = input.cursor.Next();
    inputs.push_back(std::move(input));
  }
  RecordingFile file(std::move(options), channels);
  try {
    for (const Input& input : inputs) WriteHeldAt(selection.start, input, file, problems);
    Merge(inputs, file);
    file.Close();
  } catch (...) {
    file.DiscardAll();
    throw;
  }
  for (const Input& input : inputs) problems.Add(input.cursor.problems());
  return problems;
}

}  // namespace thalweg::recorder
