#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace thalweg {

enum class Compression { kNone, kLz4, kZstd };

/// The name that MCAP and the command line use: "zstd", "lz4" or "" (on the command line "none").
std::string_view NameOf(Compression compression);

/// Compresses for speed rather than size: zstd at level 1, lz4 as one frame.
std::vector<std::uint8_t> Compress(Compression compression, Bytes bytes);

/// @param name  As in a chunk: "", "lz4" or "zstd".
/// @param size  Size of the result, as the file claims it. The caller has bounded it; memory is reserved for
///              what the bytes really hold, up to that size.
/// @return      Exactly `size` bytes, or what is wrong with `bytes`.
Result<std::vector<std::uint8_t>> Decompress(std::string_view name, Bytes bytes, std::uint64_t size);

/// CRC-32 as in zlib, of bytes that follow those of `before`.
std::uint32_t Crc32(Bytes bytes, std::uint32_t before = 0);

}  // namespace thalweg
