#pragma once

#include <optional>

#include "common/base/time.h"

namespace thalweg {

/// Follows the stamps of a stream whose samples must be later than the one before.
class StampOrder {
 public:
  enum class Verdict {
    kLater,
    kNotLater,   ///< A repeated sample, or one out of order; it changes nothing.
    kRestarted,  ///< So much earlier that the clock was restarted: the stream begins again with it.
  };

  Verdict Judge(Time stamp) {
    const bool later = !newest_ || stamp > *newest_;
    if (!later && *newest_ - stamp < kClockRestart) return Verdict::kNotLater;
    newest_ = stamp;
    return later ? Verdict::kLater : Verdict::kRestarted;
  }

  /// The stamp of the sample that was accepted last.
  const std::optional<Time>& newest() const { return newest_; }

  /// Whether this stamp, of another stream by the same clock, is from before a restart that the newest sample
  /// has not followed.
  bool IsRestartedAt(Time stamp) const { return newest_ && *newest_ - stamp >= kClockRestart; }

 private:
  std::optional<Time> newest_;
};

}  // namespace thalweg
