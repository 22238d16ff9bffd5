#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "common/base/bytes.h"
#include "common/base/time.h"
#include "services/recorder/core/mcap_format.h"

namespace thalweg::recorder {

// What the parts of the reader share.

/// "byte 12: ", with which a problem begins.
inline std::string At(std::uint64_t offset) {
  return "byte " + std::to_string(offset) + ": ";
}

inline bool IsMagic(Bytes bytes) {
  return bytes.size() >= kMagic.size() && std::ranges::equal(bytes.first(kMagic.size()), kMagic);
}

/// Times beyond the range of Time do not occur: it reaches to the year 2262.
inline bool FitsTime(std::uint64_t nanoseconds) {
  return nanoseconds <= static_cast<std::uint64_t>(std::numeric_limits<Duration::rep>::max());
}

inline Time TimeFrom(std::uint64_t nanoseconds) {
  return Time{Duration(static_cast<Duration::rep>(nanoseconds))};
}

/// The last time of that range for one beyond it: the end of a span whose first part may be within.
inline Time ClampedTime(std::uint64_t nanoseconds) {
  return FitsTime(nanoseconds) ? TimeFrom(nanoseconds) : Time::max();
}

}  // namespace thalweg::recorder
