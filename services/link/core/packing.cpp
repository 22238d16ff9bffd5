#include "services/link/core/packing.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <string>

#include "common/base/check.h"

namespace thalweg::link {
namespace {

enum Method : std::uint8_t { kPlain = 0, kZstd = 1 };

constexpr int kLeastWindow = 10;  // of zstd, as a power of 2
constexpr int kLevel = 3;         // 100 kB cost about a millisecond

}  // namespace

Buffer Pack(Bytes message, Bytes before) {
  // One context a thread, since making one costs more than to pack a pose.
  static thread_local const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(),
                                                                                            ZSTD_freeCCtx);
  THALWEG_CHECK(context != nullptr && message.size() <= kMostMessageBytes);
  ZSTD_CCtx_reset(context.get(), ZSTD_reset_session_and_parameters);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_contentSizeFlag, 0);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_dictIDFlag, 0);
  // zstd chooses a window for the message alone, which would not reach back over all of `before`.
  const int window = std::bit_width(before.size() + message.size());
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, std::max(window, kLeastWindow));
  ZSTD_CCtx_refPrefix(context.get(), before.data(), before.size());
  ByteWriter out;
  out.U8(kZstd);
  out.Varint(message.size());
  Buffer compressed(ZSTD_compressBound(message.size()));
  const std::size_t size =
      ZSTD_compress2(context.get(), compressed.data(), compressed.size(), message.data(), message.size());
  THALWEG_CHECK(ZSTD_isError(size) == 0);
  if (size + out.size() > message.size()) {
    out.clear();
    out.U8(kPlain);
    out.Append(message);
  } else {
    out.Append(Bytes(compressed).first(size));
  }
  return out.Take();
}

Result<Buffer> Unpack(Bytes packed, Bytes before, std::size_t most_bytes) {
  ByteReader in(packed);
  const std::uint8_t method = in.U8();
  if (!in.good()) return Error{"an empty message"};
  if (method == kPlain) {
    if (in.rest().size() > most_bytes) return Error{"longer than " + std::to_string(most_bytes) + " bytes"};
    return Buffer(in.rest().begin(), in.rest().end());
  }
  if (method != kZstd) return Error{"packed by method " + std::to_string(method) + ", must be 0 or 1"};
  const std::uint64_t size = in.Varint();
  if (!in.good() || size > most_bytes) {
    return Error{"unpacks to " + std::to_string(size) + " bytes, at most " + std::to_string(most_bytes)};
  }
  static thread_local const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                                            ZSTD_freeDCtx);
  THALWEG_CHECK(context != nullptr);
  ZSTD_DCtx_reset(context.get(), ZSTD_reset_session_and_parameters);
  ZSTD_DCtx_refPrefix(context.get(), before.data(), before.size());
  Buffer message(size);
  const std::size_t got =
      ZSTD_decompressDCtx(context.get(), message.data(), message.size(), in.rest().data(), in.rest().size());
  if (ZSTD_isError(got) != 0) return Error{std::string("zstd: ") + ZSTD_getErrorName(got)};
  if (got != size) {
    return Error{"unpacks to " + std::to_string(got) + " bytes, not to " + std::to_string(size)};
  }
  return message;
}

}  // namespace thalweg::link
