#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/recording_file.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder::test {

using Samples = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;  ///< Payloads by topic.

/// A recording in memory that can be read.
struct OpenRecording {
  explicit OpenRecording(const std::filesystem::path& name)
      : file(name), reader(*McapReader::Open(file.bytes())) {}
  MappedFile file;
  McapReader reader;
};

inline Samples SamplesIn(const McapReader& reader) {
  Samples samples;
  MessageCursor cursor = reader.Read();
  while (const auto message = cursor.Next()) {
    samples[reader.channels().at(message->channel).topic].emplace_back(message->payload.begin(),
                                                                       message->payload.end());
  }
  return samples;
}

/// A recording of `count` empty messages of each topic, one each 20 ms.
inline void WriteRecording(const std::filesystem::path& name, const std::vector<dds::TopicInfo>& topics,
                           int count) {
  std::vector<Channel> channels;
  for (const dds::TopicInfo& topic : topics) {
    channels.push_back({.topic = "/" + topic.name, .type = dds::Ros2TypeName(topic.type_name)});
  }
  RecordingFile file({.file = name}, channels);
  const std::vector<std::uint8_t> bytes(100);
  for (int k = 0; k < count; ++k) {
    const Time time{std::chrono::milliseconds(20 * k)};
    for (std::size_t topic = 0; topic < topics.size(); ++topic) {
      file.Write(topic, static_cast<std::uint32_t>(k), time, time, bytes);
    }
  }
  file.Close();
}

/// A test that has an empty folder of its own.
class ScratchFolder : public testing::Test {
 protected:
  ScratchFolder() : folder_(testing::TempDir() + "/recorder-" + std::to_string(getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ScratchFolder() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

}  // namespace thalweg::recorder::test
