#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/dds/bus.h"
#include "services/inspector/adapter/open_topic.h"
#include "services/inspector/adapter/topic_listener.h"
#include "services/inspector/core/delay.h"
#include "services/inspector/core/field_path.h"

namespace thalweg::inspector {

/// Measures how late the messages of a topic are by the stamps in their headers; hears the run's clock, too.
///
/// Threading: that of the bus.
class DelayListener {
 public:
  /// @param bus  As for TopicListener; must not use the run's clock in another way. Surveys, so that other
  /// machines are known.
  /// @param most_messages  As many as the figures are computed from.
  /// @param machine_clock  As for StampDelay.
  /// Throws std::runtime_error for a topic whose messages have no header.
  DelayListener(dds::Bus& bus, const OpenTopic& topic, std::size_t most_messages, bool machine_clock);

  std::uint64_t received() const { return listener_.received(); }  ///< Messages, malformed ones included.
  /// See DelayReport.
  std::optional<std::string> Report();

 private:
  void OnMessage(const Value& message, const dds::RawSample& sample);

  /// For people: who a message says it is of, as in `health`, or else who publishes the topic.
  std::string SenderOf(const Value& message) const;

  dds::Bus& bus_;
  FieldPath stamp_;
  std::optional<FieldPath> service_;  ///< The name of its service, where a message has it.
  StampDelay delay_;
  DelayReport report_{delay_};
  TopicListener listener_;
};

}  // namespace thalweg::inspector
