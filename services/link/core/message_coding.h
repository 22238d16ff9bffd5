#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.h"
#include "services/link/core/packing.h"

namespace thalweg::link {

/// Bytes of a message on the wire.
/// @param offered  When it was offered; crosses in milliseconds modulo 2^32.
/// @param preface  Crosses with it; null = none.
/// @param before   The channel's last message, with which it is packed; null = it is packed already.
Buffer EncodeMessage(Bytes message, Duration offered, const Buffer* preface, const Buffer* before);

struct DecodedMessage {
  Buffer bytes;
  std::uint32_t offered_ms = 0;
  std::optional<Buffer> preface;
};
/// @param before  As for EncodeMessage. Error: what is wrong with the bytes.
Result<DecodedMessage> DecodeMessage(Bytes wire, const Buffer* before);

inline std::uint32_t MillisecondsOf(Duration steady) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(steady).count());
}

}  // namespace thalweg::link
