#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/dds/bus.h"
#include "services/inspector/adapter/open_topic.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// Receives and decodes the messages of one topic, of all its writers.
///
/// Threading: that of the bus.
class TopicListener {
 public:
  using Handler = std::function<void(const Value& message, const dds::RawSample& sample)>;

  /// @param bus  Must not use the topic in another way. Outlives the listener, which outlives its spinning.
  TopicListener(dds::Bus& bus, OpenTopic topic, Handler handler);
  TopicListener(const TopicListener&) = delete;
  TopicListener& operator=(const TopicListener&) = delete;

  const OpenTopic& topic() const { return topic_; }
  std::uint64_t received() const { return received_; }    ///< Messages, malformed ones included.
  std::uint64_t malformed() const { return malformed_; }  ///< Those that could not be decoded.
  /// "odometry: header.frame_id: ...": why the last of them could not.
  const std::string& last_error() const { return last_error_; }

 private:
  void OnSample(const dds::RawSample& sample);

  OpenTopic topic_;
  Handler handler_;
  std::uint64_t received_ = 0;
  std::uint64_t malformed_ = 0;
  std::string last_error_;
};

}  // namespace thalweg::inspector
