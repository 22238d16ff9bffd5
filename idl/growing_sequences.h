#pragma once

#include <fastcdr/Cdr.h>

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

// Included before everything else into the code that fastddsgen generates.

namespace eprosima::fastcdr {

/// Decodes a sequence of structures or strings one by one. Fast CDR's own version first makes as many as the
/// message claims, of which it only checks that there are no more than bytes: 8 MB of zeros, as a path,
/// became 800 MB. Here memory grows with what has really been decoded.
///
/// Being constrained, it is preferred to Cdr::operator>>.
template <class Element>
requires std::is_class_v<Element> Cdr& operator>>(Cdr& decoder, std::vector<Element>& sequence) {
  constexpr std::uint32_t kAtOnce = 64;
  std::uint32_t count = 0;
  decoder >> count;
  sequence.clear();
  for (std::uint32_t k = 0; k < count; ++k) {
    if (sequence.size() == sequence.capacity()) {
      // Not more than twice what is there; the exact size where that is enough.
      const auto room = std::max<std::size_t>(2 * sequence.size(), kAtOnce);
      sequence.reserve(std::min<std::size_t>(room, count));
    }
    Element& element = sequence.emplace_back();
    if constexpr (requires { element.deserialize(decoder); }) {
      element.deserialize(decoder);
    } else {
      decoder >> element;
    }
  }
  return decoder;
}

}  // namespace eprosima::fastcdr
