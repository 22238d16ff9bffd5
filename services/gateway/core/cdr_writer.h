#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

namespace thalweg::gateway {

/// Writes the gateway's own messages as little-endian CDR with its encapsulation header [OMG CORBA 3.4,
/// Sec. 9.3; DDSI-RTPS 2.2, Sec. 10.2]: the format of everything else that it passes on.
class CdrWriter {
 public:
  template <class T>
  void Put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    Align(sizeof(T));
    Append(&value, sizeof(T));
  }
  template <class T>
  void PutSequence(const std::vector<T>& values) {
    Put(static_cast<std::uint32_t>(values.size()));
    if (values.empty()) return;
    Align(sizeof(T));
    Append(values.data(), values.size() * sizeof(T));
  }
  std::vector<std::uint8_t> Take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kHeader = 4;
  void Align(std::size_t size) {
    while ((bytes_.size() - kHeader) % size != 0) bytes_.push_back(0);
  }
  void Append(const void* data, std::size_t size) {
    const auto* const first = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  std::vector<std::uint8_t> bytes_ = {0, 1, 0, 0};  // CDR_LE
};

}  // namespace thalweg::gateway
