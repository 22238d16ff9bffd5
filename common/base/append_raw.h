#pragma once

#include <bit>
#include <string>
#include <type_traits>

namespace thalweg {

static_assert(std::endian::native == std::endian::little);

/// Appends a value's bytes as they are in memory, which is how binary little-endian files hold them.
template <class T>
void AppendRaw(std::string& bytes, const T& value) {
  static_assert(std::is_arithmetic_v<T>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace thalweg
