#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace thalweg {

using Bytes = std::span<const std::uint8_t>;

/// The same bytes as a text.
inline std::string_view TextOf(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Appends integers, little endian, and strings and maps as MCAP encodes them: a string after its length, a
/// map after its length in bytes, both of four bytes.
class ByteWriter {
 public:
  void U8(std::uint8_t value) { bytes_.push_back(value); }
  void U16(std::uint16_t value) { Little(value, 2); }
  void U32(std::uint32_t value) { Little(value, 4); }
  void U64(std::uint64_t value) { Little(value, 8); }
  /// Seven bits a byte, the lowest first; the eighth says that more follow.
  void Varint(std::uint64_t value) {
    for (; value >= 0x80U; value >>= 7U) bytes_.push_back(static_cast<std::uint8_t>(value | 0x80U));
    bytes_.push_back(static_cast<std::uint8_t>(value));
  }
  void Append(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void String(std::string_view text) {
    U32(static_cast<std::uint32_t>(text.size()));
    for (const char c : text) bytes_.push_back(static_cast<std::uint8_t>(c));
  }
  void Map(const std::map<std::string, std::string>& map) {
    std::size_t size = 0;
    for (const auto& [key, value] : map) size += 8 + key.size() + value.size();
    U32(static_cast<std::uint32_t>(size));
    for (const auto& [key, value] : map) {
      String(key);
      String(value);
    }
  }

  std::size_t size() const { return bytes_.size(); }
  bool empty() const { return bytes_.empty(); }
  void clear() { bytes_.clear(); }
  Bytes bytes() const { return bytes_; }
  std::vector<std::uint8_t> Take() { return std::exchange(bytes_, {}); }

 private:
  void Little(std::uint64_t value, int count) {
    for (int k = 0; k < count; ++k) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
  }
  std::vector<std::uint8_t> bytes_;
};

/// Reads what ByteWriter writes. Beyond the end it returns zeros and empty strings, and good() is false from
/// then on, so that a record is parsed whole and checked once.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes) {}

  std::uint8_t U8() { return static_cast<std::uint8_t>(Little(1)); }
  std::uint16_t U16() { return static_cast<std::uint16_t>(Little(2)); }
  std::uint32_t U32() { return static_cast<std::uint32_t>(Little(4)); }
  std::uint64_t U64() { return Little(8); }
  std::uint64_t Varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const std::uint8_t octet = U8();
      value |= std::uint64_t{octet & 0x7fU} << shift;
      if ((octet & 0x80U) == 0) return value;
    }
    good_ = false;
    return 0;
  }
  Bytes Take(std::uint64_t count) {
    if (count > rest_.size()) {
      good_ = false;
      rest_ = {};
      return {};
    }
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::string String() {
    const Bytes taken = Take(U32());
    return {taken.begin(), taken.end()};
  }
  std::map<std::string, std::string> Map() {
    ByteReader inner(Take(U32()));
    std::map<std::string, std::string> map;
    while (inner.good() && !inner.rest().empty()) {
      std::string key = inner.String();
      map[std::move(key)] = inner.String();
    }
    good_ = good_ && inner.good();
    return map;
  }

  bool good() const { return good_; }
  Bytes rest() const { return rest_; }

 private:
  std::uint64_t Little(std::size_t count) {
    std::uint64_t value = 0;
    const Bytes taken = Take(count);
    for (std::size_t k = 0; k < taken.size(); ++k) value |= std::uint64_t{taken[k]} << (8 * k);
    return value;
  }
  Bytes rest_;
  bool good_ = true;
};

}  // namespace thalweg
