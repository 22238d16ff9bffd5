#include "services/link/core/reassembly.h"

#include <string>
#include <utility>

namespace thalweg::link {

Reassembly::Reassembly(std::vector<bool> packed) {
  for (const bool is_packed : packed) channels_.emplace_back().packed = is_packed;
}

void Reassembly::Clear() {
  for (Channel& channel : channels_) channel = Channel{.packed = channel.packed, .arrived = {}, .before = {}};
  incomplete_bytes_ = 0;
}

Result<std::optional<DecodedMessage>> Reassembly::Add(const Piece& piece) {
  if (piece.channel >= channels_.size()) return Error{"channel " + std::to_string(piece.channel)};
  Channel& channel = channels_[piece.channel];
  if (piece.first != (channel.total == 0)) {
    return Error{piece.first ? "a message begins before the last one is complete"
                             : "a piece of a message that has not begun"};
  }
  if (piece.first) {
    // More than the largest message by what surrounds it.
    if (piece.total == 0 || piece.total > kMostMessageBytes + kFrameBytes) {
      return Error{"a message of " + std::to_string(piece.total) + " bytes"};
    }
    channel.total = piece.total;
  }
  const std::size_t size = channel.arrived.size() + piece.bytes.size();
  if (size > channel.total || piece.last != (size == channel.total)) {
    return Error{"a message of " + std::to_string(channel.total) + " bytes has " + std::to_string(size) +
                 (piece.last ? " at its end" : " and goes on")};
  }
  incomplete_bytes_ += piece.bytes.size();
  if (incomplete_bytes_ > kMostIncompleteBytes) return Error{"too many incomplete messages"};
  channel.arrived.insert(channel.arrived.end(), piece.bytes.begin(), piece.bytes.end());
  if (!piece.last) return std::optional<DecodedMessage>();
  const Buffer wire = std::exchange(channel.arrived, {});
  channel.total = 0;
  incomplete_bytes_ -= wire.size();
  Result<DecodedMessage> decoded = DecodeMessage(wire, channel.packed ? &channel.before : nullptr);
  if (!decoded) return Error{decoded.error()};
  if (channel.packed) channel.before = decoded->bytes;
  return std::optional<DecodedMessage>(*std::move(decoded));
}

}  // namespace thalweg::link
