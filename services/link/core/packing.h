#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace thalweg::link {

using Buffer = std::vector<std::uint8_t>;

/// Largest message that crosses, before packing: an image of 4096 x 1024 pixels in three colors fits.
inline constexpr std::size_t kMostMessageBytes = 16U << 20U;

/// Packs a message by zstd [RFC 8878], with a message that the other side has already as its dictionary: of
/// a path that is sent again, or of a pose with a covariance of zeros, only what has changed costs anything.
/// @param before  The earlier message; empty = none.
Buffer Pack(Bytes message, Bytes before = {});
/// The inverse, byte for byte. Error: bytes that Pack with this `before` did not make, or a message of more
/// than `most_bytes`. Reserves no more than `most_bytes`.
Result<Buffer> Unpack(Bytes packed, Bytes before = {}, std::size_t most_bytes = kMostMessageBytes);

}  // namespace thalweg::link
