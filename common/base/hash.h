#pragma once

#include <cstdint>
#include <string_view>

namespace thalweg {

/// FNV-1a, 64 bit [Fowler, Noll, Vo], for checksums and fingerprints. Offers no protection against deliberate
/// tampering.
/// @param hash  Hash of the preceding bytes.
inline std::uint64_t HashOf(std::string_view bytes, std::uint64_t hash = 0xCBF29CE484222325ULL) {
  for (const char c : bytes) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001B3ULL;
  return hash;
}

}  // namespace thalweg
