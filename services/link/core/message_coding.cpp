#include "services/link/core/message_coding.h"

#include <utility>

namespace thalweg::link {

Buffer EncodeMessage(Bytes message, Duration offered, const Buffer* preface, const Buffer* before) {
  ByteWriter out;
  out.U32(MillisecondsOf(offered));
  out.Varint(preface == nullptr ? 0 : preface->size() + 1);
  if (preface != nullptr) out.Append(*preface);
  if (before != nullptr) {
    out.Append(Pack(message, *before));
  } else {
    out.Append(message);
  }
  return out.Take();
}

Result<DecodedMessage> DecodeMessage(Bytes wire, const Buffer* before) {
  ByteReader in(wire);
  DecodedMessage decoded;
  decoded.offered_ms = in.U32();
  if (const std::uint64_t size = in.Varint(); size > 0) {
    const Bytes preface = in.Take(size - 1);
    decoded.preface = Buffer(preface.begin(), preface.end());
  }
  if (!in.good()) return Error{"a message is cut off"};
  if (before == nullptr) {
    decoded.bytes.assign(in.rest().begin(), in.rest().end());
    return decoded;
  }
  Result<Buffer> bytes = Unpack(in.rest(), *before);
  if (!bytes) return Error{bytes.error()};
  decoded.bytes = *std::move(bytes);
  return decoded;
}

}  // namespace thalweg::link
