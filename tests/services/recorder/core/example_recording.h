#pragma once

#include <random>
#include <string>
#include <vector>

#include "services/recorder/core/mcap_reader.h"
#include "services/recorder/core/mcap_writer.h"

namespace thalweg::recorder {

/// A message with its bytes, and its topic by name.
struct Sample {
  std::string topic;
  std::uint32_t sequence;
  Time log_time, publish_time;
  std::vector<std::uint8_t> payload;

  friend bool operator==(const Sample&, const Sample&) = default;
};

inline Time At(int milliseconds) {
  return Time{std::chrono::milliseconds(1'000'000 + milliseconds)};
}

inline std::vector<Channel> ExampleChannels() {
  Channel points{.topic = "/points", .type = "a/msg/Cloud", .schema = "uint32 n", .metadata = {{"key", "v"}}};
  Channel pose{.topic = "/pose", .type = "a/msg/Pose", .schema = "float64 x\nfloat64 y", .metadata = {}};
  Channel late = pose;
  late.topic = "/late";
  return {points, pose, late};
}

/// Messages on all three channels in order of their log time; sizes from 0 to `most_bytes`.
inline std::vector<Sample> ExampleSamples(int count, int most_bytes) {
  std::mt19937 random(1);
  const std::vector<Channel> channels = ExampleChannels();
  std::vector<std::uint32_t> sequences(channels.size());
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) {
    // The third channel begins halfway, so that its description stands in a later chunk.
    const std::size_t channel = random() % (k < count / 2 ? 2U : 3U);
    std::vector<std::uint8_t> payload(random() % (static_cast<unsigned>(most_bytes) + 1U));
    for (auto& byte : payload) byte = static_cast<std::uint8_t>(random() % 4U);
    samples.push_back({channels[channel].topic, sequences[channel]++, At(2 * k), At(2 * k - 1), payload});
  }
  return samples;
}

inline std::vector<std::uint8_t> Recorded(const std::vector<Sample>& samples, McapWriter::Options options) {
  std::vector<std::uint8_t> file;
  McapWriter writer(options, [&](Bytes bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  writer.AddMetadata({"scenario", {{"text", "mapper { }"}, {"version", "1"}}});
  std::map<std::string, std::uint16_t> numbers;
  for (const Channel& channel : ExampleChannels()) numbers[channel.topic] = writer.AddChannel(channel);
  for (const Sample& sample : samples) {
    writer.Write(numbers.at(sample.topic), sample.sequence, sample.log_time, sample.publish_time,
                 sample.payload);
  }
  writer.Close();
  return file;
}

/// All messages of a selection, and what the cursor found wrong.
inline std::vector<Sample> SamplesIn(const McapReader& reader, const Selection& selection = {},
                                     Problems* problems = nullptr) {
  std::vector<Sample> samples;
  MessageCursor cursor = reader.Read(selection);
  while (const auto message = cursor.Next()) {
    samples.push_back({reader.channels().at(message->channel).topic,
                       message->sequence,
                       message->log_time,
                       message->publish_time,
                       {message->payload.begin(), message->payload.end()}});
  }
  if (problems != nullptr) problems->Add(cursor.problems());
  return samples;
}

}  // namespace thalweg::recorder
