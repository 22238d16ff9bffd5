#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/result.h"
#include "common/base/time.h"
#include "services/gateway/core/connection_graph.h"

/// Frames of the Foxglove WebSocket protocol, version 1
/// [github.com/foxglove/ws-protocol, docs/spec.md; the newer SDK has the same frames].
namespace thalweg::gateway {

/// A message's bytes, shared by the queues of all clients.
using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

/// What a client can subscribe to. `id` is unique and never reused.
struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;         ///< cdr
  std::string schema_name;      ///< e.g. nav_msgs/msg/Path
  std::string schema;           ///< Text of the schema.
  std::string schema_encoding;  ///< ros2msg
  std::size_t depth = 1;        ///< Messages that may wait for a slow client, the newest ones.
};

/// A parameter that clients can read; `value` is JSON, or a text of which JSON knows nothing.
struct Parameter {
  std::string name;
  std::string value;
};

/// A frame to be written: `head`, then `body` if there is one.
struct Frame {
  bool binary = false;
  std::string head;
  Bytes body;
  std::size_t size() const { return head.size() + (body ? body->size() : 0); }
};

enum class StatusLevel { kInfo = 0, kWarning = 1, kError = 2 };

/// What the client may do beyond subscribing.
struct Capabilities {
  bool time = false;   ///< Time frames are sent.
  bool steer = false;  ///< It may publish commands and call services.
};
Frame ServerInfo(std::string_view name, std::string_view session, const Capabilities& capabilities);
Frame Advertise(const std::vector<Channel>& channels);
/// The services of command.h.
Frame AdvertiseServices();
/// @param id  A later status with the same id replaces this one; "" = none.
Frame Status(StatusLevel level, std::string_view message, std::string_view id = "");
Frame ServiceResponse(std::uint32_t service, std::uint32_t call, std::string_view json);
Frame ServiceCallFailure(std::uint32_t service, std::uint32_t call, std::string_view reason);
/// @param id  The request's id, returned to the client; "" = none.
Frame ParameterValues(const std::vector<Parameter>& parameters, std::string_view id);
/// What is different in `now` from `before`, which the client has: the nodes of each topic and service that
/// changed, and the names of those that are gone.
Frame ConnectionGraphUpdate(const ConnectionGraph& before, const ConnectionGraph& now);
Frame TimeFrame(Time now);
/// @param subscription  The client's id of the subscription.
Frame MessageData(std::uint32_t subscription, Time stamp, Bytes message);

struct SubscribeRequest {
  struct Item {
    std::uint32_t subscription;
    std::uint32_t channel;
  };
  std::vector<Item> items;
};
struct UnsubscribeRequest {
  std::vector<std::uint32_t> subscriptions;
};
struct GetParametersRequest {
  std::vector<std::string> names;  ///< Empty = all.
  std::string id;
};
struct SetParametersRequest {
  std::vector<Parameter> items;
  std::string id;
};
struct ParameterUpdatesRequest {
  bool subscribe;                  ///< Else the client wants no further updates of these.
  std::vector<std::string> names;  ///< Empty = all.
};
struct ConnectionGraphRequest {
  bool subscribe;  ///< Else the client wants no further updates.
};
/// The client will publish on these channels of its own.
struct ClientAdvertiseRequest {
  struct Item {
    std::uint32_t channel;
    std::string topic;
    std::string encoding;
  };
  std::vector<Item> items;
};
struct ClientUnadvertiseRequest {
  std::vector<std::uint32_t> channels;
};
struct ClientMessage {
  std::uint32_t channel;  ///< The client's number.
  std::vector<std::uint8_t> message;
};
struct ServiceCall {
  std::uint32_t service;
  std::uint32_t call;
  std::string encoding;
  std::string request;
};
/// A request that the protocol knows and the gateway does not offer, or that nobody knows.
struct UnofferedRequest {
  std::string operation;
};
using ClientRequest =
    std::variant<SubscribeRequest, UnsubscribeRequest, GetParametersRequest, SetParametersRequest,
                 ParameterUpdatesRequest, ConnectionGraphRequest, ClientAdvertiseRequest,
                 ClientUnadvertiseRequest, ClientMessage, ServiceCall, UnofferedRequest>;

/// Largest frame that a client may send; its requests are lists of a few numbers, or a command.
inline constexpr std::size_t kMaxClientFrame = 256 * 1024;

/// Reads a text frame of a client. The error says which member is wrong and what it must be.
Result<ClientRequest> ParseText(std::string_view text);
/// Reads a binary frame of a client: a message, or a service call.
Result<ClientRequest> ParseBinary(std::span<const std::uint8_t> bytes);

}  // namespace thalweg::gateway
