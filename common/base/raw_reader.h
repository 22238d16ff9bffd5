#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>

#include "common/base/bytes.h"

namespace thalweg {

static_assert(std::endian::native == std::endian::little);

/// Reads values whose bytes are as in memory, one after another: the inverse of AppendRaw.
class RawReader {
 public:
  explicit RawReader(std::string_view bytes) : rest_(bytes) {}

  /// Returns false and leaves `value` unchanged if fewer bytes are left.
  template <class T>
  bool Get(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (rest_.size() < sizeof value) return false;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return true;
  }
  /// The next `count` bytes; nothing if fewer are left.
  std::optional<Bytes> Take(std::size_t count) {
    if (rest_.size() < count) return std::nullopt;
    const Bytes taken(reinterpret_cast<const std::uint8_t*>(rest_.data()), count);
    rest_.remove_prefix(count);
    return taken;
  }
  std::string_view rest() const { return rest_; }  ///< What was not read yet.

 private:
  std::string_view rest_;
};

}  // namespace thalweg
