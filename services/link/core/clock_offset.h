#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/base/time.h"

namespace thalweg::link {

/// Offset of the other machine's clock, from the times of messages in both directions [Mills et al.: NTPv4,
/// RFC 5905, Sec. 8 and 10]: with t1 sent, t2 received there, t3 sent there, t4 received,
///   offset = ((t2 - t1) + (t3 - t4)) / 2,  delay = (t4 - t1) - (t3 - t2)
/// The one with the least delay of the last exchanges counts: its error is at most half of that delay.
///
/// Threading: one thread.
class ClockOffset {
 public:
  void Add(Duration t1, Duration t2, Duration t3, Duration t4);
  void Clear() { exchanges_.clear(); }

  struct Estimate {
    Duration offset{};  ///< The other clock minus this one.
    Duration delay{};   ///< What the round trip took.
  };
  std::optional<Estimate> estimate() const;

 private:
  static constexpr std::size_t kExchanges = 16;
  std::deque<Estimate> exchanges_;
};

}  // namespace thalweg::link
