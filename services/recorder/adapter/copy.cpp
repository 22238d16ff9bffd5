#include "services/recorder/adapter/copy.h"

#include <algorithm>
#include <map>
#include <utility>

#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

/// A recording that is being copied, and its next message.
struct Input {
  MessageCursor cursor;
  std::map<std::uint16_t, std::size_t> channels;  ///< In the copy, by number in the recording.
  std::optional<Message> next;
};

}  // namespace

Problems Copy(const std::vector<const McapReader*>& recordings, const Selection& selection,
              RecordingOptions options) {
  Problems problems;
  std::vector<Channel> channels;
  std::vector<Input> inputs;
  for (const McapReader* const recording : recordings) {
    problems.Add(recording->problems());
    Input input{.cursor = recording->Read(selection), .channels = {}, .next = std::nullopt};
    for (const auto& [number, channel] : recording->channels()) {
      const auto is_wanted = [&, topic = channel.topic](const std::string& pattern) {
        return Matches(pattern, topic);
      };
      if (!selection.topics.empty() && std::ranges::none_of(selection.topics, is_wanted)) continue;
      const auto known = std::ranges::find(channels, channel);
      input.channels[number] = static_cast<std::size_t>(known - channels.begin());
      if (known == channels.end()) channels.push_back(channel);
    }
    for (const Metadata& metadata : recording->metadata()) options.metadata.push_back(metadata);
    input.next = input.cursor.Next();
    inputs.push_back(std::move(input));
  }
  RecordingFile file(std::move(options), channels);
  for (;;) {
    Input* first = nullptr;
    for (Input& input : inputs) {
      if (input.next && (first == nullptr || input.next->log_time < first->next->log_time)) first = &input;
    }
    if (first == nullptr) break;
    const Message& message = *first->next;
    file.Write(first->channels.at(message.channel), message.sequence, message.log_time, message.publish_time,
               message.payload);
    first->next = first->cursor.Next();
  }
  file.Close();
  for (const Input& input : inputs) problems.Add(input.cursor.problems());
  return problems;
}

}  // namespace thalweg::recorder
