#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "services/gateway/core/command.h"
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
  /// Those on which clients may publish, without the leading slash, and whom they are for.
  std::map<std::string, CommandGroup> command_topics;
  std::vector<Channel> channels;
  std::vector<Parameter> parameters;
  std::map<std::uint32_t, const Feed*> feeds;  ///< By channel.
  ConnectionGraph graph = {};
  std::uint64_t graph_version = 0;  ///< Increases with each change of the graph.
};

/// Who a client is.
struct ClientInfo {
  std::string name = "client";                                       ///< As it calls itself.
  std::string address;                                               ///< Its IP address and port.
  std::optional<std::string> no_steering = "nobody may steer here";  ///< Why it may not; none = it may.
};

/// A request to set a parameter, which is carried out by a command.
struct ParameterSetting {
  std::string id;  ///< The client's of the request; "" = none.
  Parameter wanted;
};

/// To what the answer to a command belongs.
struct CommandTicket {
  std::optional<std::uint32_t> service;  ///< The one called; none = it was published, or is a setting.
  std::uint32_t call = 0;  ///< The client's number of the call, or one of the published command.
  std::optional<ParameterSetting> setting = {};
};

/// A command of a client that waits for its answer.
struct ClientCommand {
  CommandTicket ticket;
  std::variant<Command, std::vector<std::uint8_t>>
      content;  ///< The bytes: a CDR sample of the group's topic.
  CommandGroup group = CommandGroup::kOperator;
};

/// One client: its subscriptions, its commands, and what waits to be written to it.
///
/// The queue is bounded whatever the client does. Of each channel it holds the newest message only, or few
/// where several writers share a topic, since none replaces another's; small messages (poses, states) go
/// before large ones (clouds, images, blocks), and among equals the one that has waited longest goes first.
/// Replies to the client's own requests are limited in number, and a client that exceeds the limit, or sends
/// too many invalid frames, is to be closed: see closing(). Commands come as messages that the client
/// publishes on operator/command or replay/command, or as calls of services; those beyond kCommandsPerSecond,
/// or while kMaxPending others wait for their answers, are refused.
///
/// Threading: one thread.
class Session {
 public:
  static constexpr std::size_t kLargeMessage = 64 * 1024;  ///< [byte] From here on, a message is large.
  static constexpr std::size_t kMaxReplies = 256;
  static constexpr std::size_t kMaxSubscriptions = 256;
  static constexpr int kMaxInvalidFrames = 20;

  static constexpr double kCommandsPerSecond = 5.0;
  static constexpr double kCommandBurst = 10.0;
  static constexpr std::size_t kMaxPending = 8;

  /// `content` must outlive the session.
  explicit Session(const ServerContent& content, ClientInfo client = {});

  /// @param now  On any clock that never goes back.
  void OnText(std::string_view text, Duration now = {});
  void OnBinary(std::span<const std::uint8_t> bytes, Duration now = {});

  /// Commands since the last call. Each must be answered.
  std::vector<ClientCommand> TakeCommands();
  void Answer(const CommandTicket& ticket, const CommandAnswer& answer);
  /// Answers a command whose CDR sample cannot be decoded; counts as an invalid frame.
  void AnswerInvalid(const CommandTicket& ticket, const std::string& reason);

  /// Queues a message if the client has subscribed to the channel. @return Whether it has.
  bool Offer(std::uint32_t channel, Time stamp, const Bytes& message);
  void OfferTime(Time now);  ///< Replaces an earlier time that has not been written.
  /// A parameter of the content has changed. Only its newest value waits.
  void OnParameterChange(const std::string& name);

  /// The next frame to be written, if there is one.
  std::optional<Frame> Next();

  bool Wants(std::uint32_t channel) const { return by_channel_.contains(channel); }
  bool wants_graph() const { return graph_.has_value(); }
  /// Channels subscribed to since the last call.
  std::vector<std::uint32_t> TakeNewSubscriptions();
  /// Why the connection must be closed, if it must.
  const std::optional<std::string>& closing() const { return closing_; }

  /// Messages replaced by newer ones before they could be written.
  std::uint64_t dropped() const { return dropped_; }
  int invalid_frames() const { return invalid_frames_; }
  const std::string& last_invalid() const { return last_invalid_; }
  std::uint64_t commands() const { return commands_; }
  std::uint64_t refused_commands() const { return refused_commands_; }  ///< By the gateway.
  const std::string& last_refused() const { return last_refused_; }
  std::size_t waiting_bytes() const;  ///< Size of messages and replies that are not written.
  const ClientInfo& client() const { return client_; }

 private:
  struct Subscription {
    std::uint32_t id = 0;
    std::size_t depth = 1;
    std::deque<std::pair<Time, Bytes>> waiting;  ///< Oldest first.
    std::uint64_t turn = 0;                      ///< When the oldest was queued, or a feed was last written.
    const Feed* feed = nullptr;
    std::uint64_t cursor = 0;
  };

  void Handle(const Result<ClientRequest>& request, Duration now);
  void CountInvalid(const std::string& reason);
  void Do(const SubscribeRequest& request);
  void Do(const UnsubscribeRequest& request);
  void Do(const GetParametersRequest& request);
  void Do(const SetParametersRequest& request);
  void Do(const ParameterUpdatesRequest& request);
  void Do(const ConnectionGraphRequest& request);
  void Do(const ClientAdvertiseRequest& request);
  void Do(const ClientUnadvertiseRequest& request);
  void Do(const ClientMessage& request);
  void Do(const ServiceCall& request);
  void Do(const UnofferedRequest& request);
  void Take(const CommandTicket& ticket, CommandGroup group, const Result<Command>& command);
  std::optional<std::string> WhyNotNow();
  void Refuse(const CommandTicket& ticket, const std::string& reason);
  void RefuseInvalid(const CommandTicket& ticket, const std::string& reason);
  void Reply(Frame frame);
  std::vector<Parameter> ParametersNamed(const std::vector<std::string>& names) const;
  std::optional<Frame> NextSample(bool large);
  std::optional<Frame> NextOfFeeds();

  const ServerContent& content_;
  ClientInfo client_;
  Duration now_ = {};
  /// A channel of the client's own.
  struct Published {
    std::optional<CommandGroup> group;  ///< None: nobody takes what is published there.
    std::string encoding;
  };
  std::map<std::uint32_t, Published> published_;
  std::vector<ClientCommand> new_commands_;
  std::size_t pending_ = 0;  ///< Commands that are not answered.
  double allowance_ = kCommandBurst;
  Duration allowance_at_ = {};
  std::uint32_t messages_ = 0;  ///< Numbers the published commands.
  std::uint64_t commands_ = 0;
  std::uint64_t refused_commands_ = 0;
  std::string last_refused_;
  std::deque<Frame> replies_;
  std::optional<Time> time_;
  std::set<std::string> watched_;         ///< Parameters of whose changes the client wants to hear,
  std::set<std::string> changed_;         ///< and those of them that have changed since it did.
  std::optional<ConnectionGraph> graph_;  ///< As the client has it, if it wants it.
  std::uint64_t graph_version_ = 0;       ///< The version that the client has; 0 = none yet.
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
