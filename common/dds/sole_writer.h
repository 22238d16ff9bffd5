#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "common/base/time.h"

namespace thalweg::dds {

/// Keeps a reader to one writer of a topic that has only one: a second one, by mistake or by intent, would
/// mix its samples with those of the first. The reader follows the writer that it received first until that
/// one is gone or silent.
///
/// Threading: one thread.
template <class Id>
class SoleWriter {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;

  /// A writer that sends nothing for `silence` may be replaced by another.
  explicit SoleWriter(Duration silence) : silence_(silence) {}

  /// Whether a sample that `writer` sent and that arrived at `now` is to be used.
  /// @param is_matched  Whether a writer still exists.
  bool Accepts(const Id& writer, SteadyTime now, const std::function<bool(const Id&)>& is_matched) {
    if (followed_ != writer) {
      if (followed_ && now - last_ <= silence_ && is_matched(*followed_)) return false;
      followed_ = writer;
    }
    last_ = now;
    return true;
  }

  /// The writer that is followed; nothing before the first sample.
  const std::optional<Id>& followed() const { return followed_; }

 private:
  Duration silence_;
  std::optional<Id> followed_;
  SteadyTime last_;
};

}  // namespace thalweg::dds
