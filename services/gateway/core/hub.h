#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "services/gateway/core/block_feed.h"
#include "services/gateway/core/history_feed.h"
#include "services/gateway/core/map_points.h"
#include "services/gateway/core/session.h"
#include "services/gateway/core/surface_feed.h"

namespace thalweg::gateway {

/// A topic of the system as a channel.
struct TopicChannel {
  std::string topic;
  std::string schema_name;
  std::string schema;
  bool keeps_last = false;  ///< A client that subscribes late receives the newest message of each part.
  std::size_t depth = 1;    ///< Messages that may wait for a slow client, and parts that are kept.
};

/// All clients and what they are offered.
///
/// Threading: one thread.
class Hub {
 public:
  using ClientId = std::uint64_t;
  static constexpr std::size_t kMaxClients = 32;

  struct Options {
    std::string name;
    std::string session_id;
    bool with_time = false;
    std::vector<TopicChannel> topics;  ///< Topic n has channel id n + 1.
    std::vector<Parameter> parameters;
    std::map<std::string, CommandGroup> command_topics = {};  ///< On which clients may publish.
    std::string surface_topic = {};    ///< Wanted also by those who want the surface's own channel.
    std::string map_points_type = {};  ///< Name and schema of sensor_msgs/msg/PointCloud2.
    std::string map_points_schema = {};
    std::string map_frame = "map";  ///< As it is called on the wire.
  };
  explicit Hub(Options options);
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  /// Counts a request that was answered by an error, e.g. for want of the token.
  void CountRefusedRequest(std::string reason);

  bool full() const { return sessions_.size() >= kMaxClients; }
  ClientId Connect(ClientInfo client = {});
  void Disconnect(ClientId client);
  Session& session(ClientId client) { return sessions_.at(client); }
  std::vector<ClientId> clients() const;

  /// Passes a frame of a client on, and gives it the last messages of channels to which it has subscribed.
  /// @param now  On any clock that never goes back.
  void OnText(ClientId client, std::string_view text, Duration now = {});
  void OnBinary(ClientId client, std::span<const std::uint8_t> bytes, Duration now = {});

  /// Answers a command of Session::TakeCommands, unless the client has left.
  void Answer(ClientId client, const CommandTicket& ticket, const CommandAnswer& answer);
  void AnswerInvalid(ClientId client, const CommandTicket& ticket, const std::string& reason);

  /// A topic that nobody wants any longer is kept open this long, so that a client that comes and goes, or
  /// subscribes and unsubscribes in turns, does not make the bus announce a reader each time.
  static constexpr Duration kLinger = std::chrono::seconds(10);

  /// Topics, by index, that some client has come to want, or none has wanted for kLinger.
  struct WantedChanges {
    std::vector<std::size_t> begun;
    std::vector<std::size_t> ended;
  };
  /// The changes since the last call. The last message of a topic that has ended is forgotten, since it will
  /// be out of date.
  /// @param now  On any clock that never goes back.
  WantedChanges TakeWantedChanges(Duration now = {});

  /// @param part  Where several publish parts of a state: which of them the message is. For clients that
  ///              subscribe late, it replaces the last message of the same part.
  void Publish(std::size_t topic, Time stamp, const Bytes& message, std::uint64_t part = 0);
  void PublishTime(Time now);
  /// States the strategy that the explorer follows, as the parameter kStrategyParameter.
  void SetStrategy(const std::string& name);
  /// Converts the map to points again, if a client wants them and the map has changed; at most once a second.
  void RefreshMapPoints(Duration now);
  /// Clients that want the graph receive what is different from the last one.
  void SetGraph(ConnectionGraph graph);
  bool graph_wanted() const;  ///< By some client.
  BlockFeed& blocks() { return blocks_; }
  HistoryFeed& history() { return history_; }
  SurfaceFeed& surface() { return surface_; }
  /// Whether a client wants surface_topic itself, and not only the surface's own channel.
  bool surface_topic_wanted() const;

  struct Counts {
    std::size_t clients = 0;
    std::uint64_t replaced = 0;        ///< Messages replaced by newer ones before a slow client took them.
    std::uint64_t invalid_frames = 0;  ///< Sent by clients.
    std::string last_invalid;
    std::uint64_t commands = 0;
    std::uint64_t refused_commands = 0;  ///< By the gateway: too many, or malformed.
    std::string last_refused;
    std::uint64_t refused_requests = 0;  ///< Before they became clients.
    std::string last_refused_request;
    std::size_t waiting_bytes = 0;  ///< Size of what clients have yet to take.
  };
  Counts counts() const;  ///< Since the start, including clients that have left.

 private:
  struct Kept {
    std::uint64_t part;
    Time stamp;
    Bytes message;
  };
  BlockFeed blocks_;
  HistoryFeed history_;
  MapPointsFeed map_points_;
  std::uint32_t map_points_channel_ = 0;
  SurfaceFeed surface_;
  std::uint32_t surface_channel_ = 0;
  std::optional<std::size_t> surface_topic_;
  std::vector<bool> keeps_last_;
  ServerContent content_;
  std::map<ClientId, Session> sessions_;
  ClientId last_client_ = 0;
  std::map<std::uint32_t, std::vector<Kept>> kept_;        ///< By channel, oldest first.
  std::map<std::size_t, std::optional<Duration>> wanted_;  ///< By topic: since when nobody wants it.
  Counts departed_;
};

}  // namespace thalweg::gateway
