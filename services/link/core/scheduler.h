#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/link/core/frame.h"

namespace thalweg::link {

/// What goes first when not everything fits.
enum class Priority : std::uint8_t {
  kCommand,  ///< What moves the robot, and what operators say.
  kPose,     ///< Poses and the clock.
  kState,    ///< Statuses.
  kMap,      ///< Blocks of the map.
  kBulk,     ///< Clouds, images and pictures of the map.
};

/// How the messages of a channel cross.
struct ChannelPolicy {
  std::string name;
  Priority priority = Priority::kBulk;
  /// Messages that may wait. One more drops the oldest, so that with 1 the newest wins.
  std::size_t most_waiting = 1;
  /// A new session repeats the last message, as for a reader that joins late.
  bool repeats_last = false;
  /// A new session repeats the messages that were not acknowledged. With messages that wait in order: none is
  /// lost as long as both sides live.
  bool repeats_unacknowledged = false;
  /// While the link is cut, messages are kept and cross later, in order.
  bool kept = false;
  /// Whether messages are packed here, with the one before as their dictionary.
  bool packed = true;
};

/// A message on its way.
struct Message {
  Buffer bytes;
  Duration offered{};  ///< When, by a steady clock.
  /// What the other side needs to understand the message; crosses before it, unless it was that of the
  /// channel's last message.
  std::shared_ptr<const Buffer> preface = nullptr;
};

/// Decides what goes into the next frame.
///
/// The most urgent pieces first; of channels that are equally urgent, a piece each in turn. A message that
/// has started to cross is finished, but never holds up a more urgent one by more than a frame. Messages are
/// packed when they start, so that those which are replaced before cost nothing.
///
/// Memory: that of the messages that may wait. Threading: one thread.
class Scheduler {
 public:
  explicit Scheduler(std::vector<ChannelPolicy> policies);

  /// @param at_front  Whether the message precedes those that wait.
  void Offer(std::size_t channel, Message message, bool at_front = false);
  /// Where a channel gets its messages when it is their turn; returns nothing if there is none.
  void SetSource(std::size_t channel, std::function<std::optional<Message>(Duration now)> source);

  /// A message whose last piece went into a frame.
  struct Finished {
    std::size_t channel;
    Message message;
  };
  /// Appends pieces to a frame of at most kFrameBytes.
  /// @param least  Only what is at least this urgent.
  std::vector<Finished> Fill(ByteWriter& frame, Priority least, Duration now);

  bool idle(std::size_t channel) const;  ///< Whether nothing waits or crosses.
  std::size_t waiting(std::size_t channel) const { return channels_[channel].waiting.size(); }
  std::deque<Message> TakeWaiting(std::size_t channel);

  /// Begins a session: what has started to cross starts again, and what repeats_last says is repeated.
  void Restart(Duration now);

  struct Counts {
    std::uint64_t offered = 0;
    std::uint64_t dropped = 0;  ///< Replaced by newer ones before they started.
    std::uint64_t sent = 0;
    std::uint64_t bytes = 0;  ///< On the wire, of the messages that were sent.
    std::uint64_t pieces = 0;
  };
  const Counts& counts(std::size_t channel) const { return channels_[channel].counts; }
  const ChannelPolicy& policy(std::size_t channel) const { return channels_[channel].policy; }
  std::size_t channels() const { return channels_.size(); }

 private:
  struct Channel {
    ChannelPolicy policy;
    std::deque<Message> waiting;
    std::optional<Message> crossing;
    Buffer wire;          ///< The message that crosses.
    std::size_t put = 0;  ///< Bytes of `wire` that are in frames.
    Buffer before;        ///< The last message that started.
    std::shared_ptr<const Buffer> preface;
    std::optional<Message> last;  ///< To be repeated.
    std::function<std::optional<Message>(Duration)> source;
    Counts counts;
  };
  bool StartNext(Channel& channel, Duration now);
  bool PutPiece(std::size_t index, ByteWriter& frame, std::vector<Finished>& finished);

  std::vector<Channel> channels_;
  std::size_t turn_ = 0;  ///< The channel that comes first among equals.
};

}  // namespace thalweg::link
