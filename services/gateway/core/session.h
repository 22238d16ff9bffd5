#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/gateway/core/protocol.h"

namespace thalweg::gateway {

/// A channel whose messages depend on what the client already has, such as the changed blocks of a map.
/// Nothing is queued for it: its next message is made when the client can take it.
class Feed {
 public:
  struct Message {
    Time stamp;
    Bytes bytes;
  };
  virtual ~Feed() = default;
  /// The next message for a client at `cursor`, which it advances; nothing if the client has everything.
  /// A cursor of 0 has nothing yet.
  virtual std::optional<Message> Next(std::uint64_t& cursor) const = 0;
};

/// What all sessions share.
struct ServerContent {
  std::string name;
  std::string session_id;  ///< Differs after each start, upon which clients reset.
  bool with_time = false;  ///< Whether time frames are sent: the run has a clock of its own.
  std::vector<Channel> channels;
  std::vector<Parameter> parameters;
  std::map<std::uint32_t, const Feed*> feeds;  ///< By channel.
};

/// One client: its subscriptions, and what waits to be written to it.
///
/// The queue is bounded whatever the client does. Of each channel it holds the newest message only; small
/// messages (poses, states) go before large ones (clouds, images, blocks), and among equals the one that
/// has waited longest goes first. Replies to the client's own requests are limited in number, and
/// a client that exceeds the limit, or sends too many invalid frames, is to be closed: see closing().
///
/// Threading: one thread.
class Session {
 public:
  static constexpr std::size_t kLargeMessage = 64 * 1024;  ///< [byte] From here on, a message is large.
  static constexpr std::size_t kMaxReplies = 256;
  static constexpr std::size_t kMaxSubscriptions = 256;
  static constexpr int kMaxInvalidFrames = 20;

  explicit Session(const ServerContent& content);  ///< `content` must outlive the session.

  void OnText(std::string_view text);
  void OnBinary(std::span<const std::uint8_t> bytes);

  /// Queues a message if the client has subscribed to the channel. @return Whether it has.
  bool Offer(std::uint32_t channel, Time stamp, const Bytes& message);
  void OfferTime(Time now);  ///< Replaces an earlier time that has not been written.

  /// The next frame to be written, if there is one.
  std::optional<Frame> Next();

  bool Wants(std::uint32_t channel) const { return by_channel_.contains(channel); }
  /// Channels subscribed to since the last call.
  std::vector<std::uint32_t> TakeNewSubscriptions();
  /// Why the connection must be closed, if it must.
  const std::optional<std::string>& closing() const { return closing_; }

  /// Messages replaced by newer ones before they could be written.
  std::uint64_t dropped() const { return dropped_; }
  int invalid_frames() const { return invalid_frames_; }
  const std::string& last_invalid() const { return last_invalid_; }

 private:
  struct Subscription {
    std::uint32_t id = 0;
    Time stamp;
    Bytes waiting;           ///< Null = nothing waits.
    std::uint64_t turn = 0;  ///< When `waiting` was queued first, or a feed was last written.
    const Feed* feed = nullptr;
    std::uint64_t cursor = 0;
  };

  void Handle(const Result<ClientRequest>& request);
  void Do(const SubscribeRequest& request);
  void Do(const UnsubscribeRequest& request);
  void Do(const GetParametersRequest& request);
  void Do(const SetParametersRequest& request);
  void Do(const UnofferedRequest& request);
  void Reply(Frame frame);
  std::optional<Frame> NextSample(bool large);
  std::optional<Frame> NextOfFeeds();

  const ServerContent& content_;
  std::deque<Frame> replies_;
  std::optional<Time> time_;
  std::map<std::uint32_t, Subscription> by_channel_;
  std::map<std::uint32_t, std::uint32_t> channel_of_;  ///< By the client's id of the subscription.
  std::vector<std::uint32_t> new_subscriptions_;
  std::optional<std::string> closing_;
  std::uint64_t turn_ = 0;
  bool feeds_turn_ = false;  ///< Feeds and large messages alternate.
  std::uint64_t dropped_ = 0;
  int invalid_frames_ = 0;
  std::string last_invalid_;
};

}  // namespace thalweg::gateway
