#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/link/core/frame.h"
#include "services/link/core/message_coding.h"

namespace thalweg::link {

/// Puts messages together from pieces, for bytes from anywhere.
///
/// Memory: what has arrived of one message a channel, and the last message of channels that are packed
/// here; each at most kMostMessageBytes, all that is incomplete at most kMostIncompleteBytes.
/// Threading: one thread.
class Reassembly {
 public:
  static constexpr std::size_t kMostIncompleteBytes = 64U << 20U;
  /// @param packed  By channel, whether messages are packed with the one before as their dictionary.
  explicit Reassembly(std::vector<bool> packed);

  /// Takes the next piece of a session. Returns the message that it completes. Error: a piece that does not
  /// follow those before, or a message that cannot be decoded; the session cannot be followed any further.
  Result<std::optional<DecodedMessage>> Add(const Piece& piece);
  void Clear();  ///< Begins a session.

 private:
  struct Channel {
    bool packed = true;
    std::size_t total = 0;  ///< Size of the message that arrives; 0 = none.
    Buffer arrived;
    Buffer before;
  };
  std::vector<Channel> channels_;
  std::size_t incomplete_bytes_ = 0;
};

}  // namespace thalweg::link
