#pragma once

#include <functional>
#include <string>
#include <utility>

#include "services/inspector/adapter/topic_listener.h"

namespace thalweg::inspector {

/// Says why the first of a topic's malformed messages could not be decoded, and at the end how many there
/// were.
class MistakeReport {
 public:
  using Say = std::function<void(const std::string& text)>;

  /// @param listener  Outlives the report.
  MistakeReport(const TopicListener& listener, Say say) : listener_(listener), say_(std::move(say)) {}
  ~MistakeReport();
  MistakeReport(const MistakeReport&) = delete;
  MistakeReport& operator=(const MistakeReport&) = delete;

  void Look();  ///< Says what is wrong with the first malformed message, once there is one.

 private:
  const TopicListener& listener_;
  Say say_;
  bool shown_ = false;
};

}  // namespace thalweg::inspector
