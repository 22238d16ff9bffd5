#include "common/compression/compression.h"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "common/base/check.h"

namespace thalweg {
namespace {

using Buffer = std::vector<std::uint8_t>;

Buffer CompressZstd(Bytes bytes) {
  Buffer compressed(ZSTD_compressBound(bytes.size()));
  constexpr int kLevel = 1;  // keeps up with raw images on one core
  const std::size_t size =
      ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), kLevel);
  THALWEG_CHECK(ZSTD_isError(size) == 0);
  compressed.resize(size);
  return compressed;
}

Buffer CompressLz4(Bytes bytes) {
  Buffer compressed(LZ4F_compressFrameBound(bytes.size(), nullptr));
  const std::size_t size =
      LZ4F_compressFrame(compressed.data(), compressed.size(), bytes.data(), bytes.size(), nullptr);
  THALWEG_CHECK(LZ4F_isError(size) == 0);
  compressed.resize(size);
  return compressed;
}

/// One step of a decoder: consumes bytes from the front of `in`, appends to `out`, and returns a text if it
/// fails. `done` is set at the end of a frame.
using Step = std::function<std::string(Bytes& in, std::span<std::uint8_t>& out, bool& done)>;

/// Grows the result as bytes come out of the decoder, so that a false claim of a size costs nothing.
Result<Buffer> DecompressBySteps(Bytes bytes, std::uint64_t size, const Step& step) {
  constexpr std::uint64_t kFirst = 1 << 16;
  Buffer result;
  std::uint64_t filled = 0;
  bool done = bytes.empty();
  while (!done) {
    if (filled == result.size()) {
      if (filled == size) break;
      const std::uint64_t more = std::max(kFirst, std::max<std::uint64_t>(bytes.size() * 4, filled));
      result.resize(std::min(size, filled + more));
    }
    std::span<std::uint8_t> out(result.data() + filled, result.size() - filled);
    const std::size_t before = out.size();
    const std::size_t left = bytes.size();
    if (std::string failure = step(bytes, out, done); !failure.empty()) return Error{std::move(failure)};
    filled += before - out.size();
    if (done && !bytes.empty()) done = false;  // several frames in a row
    if (!done && before == out.size() && left == bytes.size()) break;
  }
  if (filled != size || !bytes.empty()) {
    return Error{"decompresses to " + std::to_string(filled) + (bytes.empty() ? "" : " or more") +
                 " bytes, its record says " + std::to_string(size)};
  }
  result.resize(filled);
  return result;
}

Result<Buffer> DecompressZstd(Bytes bytes, std::uint64_t size) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             ZSTD_freeDStream);
  constexpr int kMostWindowLog = 27;  // 128 MB, zstd's own limit for streams
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, kMostWindowLog);
  return DecompressBySteps(bytes, size,
                           [&](Bytes& in, std::span<std::uint8_t>& out, bool& done) -> std::string {
                             ZSTD_inBuffer input{in.data(), in.size(), 0};
                             ZSTD_outBuffer output{out.data(), out.size(), 0};
                             const std::size_t left = ZSTD_decompressStream(stream.get(), &output, &input);
                             if (ZSTD_isError(left) != 0)
                               return std::string("zstd: ") + ZSTD_getErrorName(left);
                             in = in.subspan(input.pos);
                             out = out.subspan(output.pos);
                             done = left == 0;
                             return "";
                           });
}

Result<Buffer> DecompressLz4(Bytes bytes, std::uint64_t size) {
  LZ4F_dctx* context = nullptr;
  THALWEG_CHECK(LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) == 0);
  const std::unique_ptr<LZ4F_dctx, std::size_t (*)(LZ4F_dctx*)> owner(context, LZ4F_freeDecompressionContext);
  return DecompressBySteps(
      bytes, size, [&](Bytes& in, std::span<std::uint8_t>& out, bool& done) -> std::string {
        std::size_t consumed = in.size();
        std::size_t produced = out.size();
        const std::size_t left =
            LZ4F_decompress(context, out.data(), &produced, in.data(), &consumed, nullptr);
        if (LZ4F_isError(left) != 0) return std::string("lz4: ") + LZ4F_getErrorName(left);
        in = in.subspan(consumed);
        out = out.subspan(produced);
        done = left == 0;
        return "";
      });
}

}  // namespace

std::string_view NameOf(Compression compression) {
  switch (compression) {
    case Compression::kNone:
      return "";
    case Compression::kLz4:
      return "lz4";
    case Compression::kZstd:
      return "zstd";
  }
  return "";
}

std::vector<std::uint8_t> Compress(Compression compression, Bytes bytes) {
  switch (compression) {
    case Compression::kNone:
      break;
    case Compression::kLz4:
      return CompressLz4(bytes);
    case Compression::kZstd:
      return CompressZstd(bytes);
  }
  return {bytes.begin(), bytes.end()};
}

Result<std::vector<std::uint8_t>> Decompress(std::string_view name, Bytes bytes, std::uint64_t size) {
  if (name == "zstd") return DecompressZstd(bytes, size);
  if (name == "lz4") return DecompressLz4(bytes, size);
  if (!name.empty()) return Error{"compressed by \"" + std::string(name) + "\", must be zstd, lz4 or none"};
  if (bytes.size() != size) {
    return Error{"holds " + std::to_string(bytes.size()) + " bytes, its record says " + std::to_string(size)};
  }
  return Buffer(bytes.begin(), bytes.end());
}

std::uint32_t Crc32(Bytes bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

}  // namespace thalweg
