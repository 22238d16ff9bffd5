#include "services/gateway/core/protocol.h"

#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "services/gateway/core/command.h"
#include "services/gateway/core/json_text.h"

namespace thalweg::gateway {
namespace {

using nlohmann::json;

Frame TextFrame(const json& value) {
  return {false, Dump(value), nullptr};
}

template <class Unsigned>
void AppendLittleEndian(std::string& bytes, Unsigned value) {
  for (std::size_t k = 0; k < sizeof(Unsigned); ++k)
    bytes.push_back(static_cast<char>((value >> (8 * k)) & 0xff));
}

/// A whole number from 0 to 2^32 - 1; nothing otherwise.
std::optional<std::uint32_t> Id(const json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

/// The member `name` if it is an array.
const json* Array(const json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_array() ? &*found : nullptr;
}

std::string Text(const json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Result<ClientRequest> ParseSubscribe(const json& object) {
  const json* const items = Array(object, "subscriptions");
  if (items == nullptr) return Error{"subscribe: \"subscriptions\" must be a list"};
  SubscribeRequest request;
  for (const json& item : *items) {
    const bool is_object = item.is_object() && item.contains("id") && item.contains("channelId");
    const std::optional<std::uint32_t> subscription = is_object ? Id(item["id"]) : std::nullopt;
    const std::optional<std::uint32_t> channel = is_object ? Id(item["channelId"]) : std::nullopt;
    if (!subscription || !channel) {
      return Error{
          "subscribe: each subscription must have \"id\" and \"channelId\", numbers from 0 to 2^32 - 1"};
    }
    request.items.push_back({*subscription, *channel});
  }
  return ClientRequest(std::move(request));
}

Result<ClientRequest> ParseUnsubscribe(const json& object) {
  const json* const items = Array(object, "subscriptionIds");
  if (items == nullptr) return Error{"unsubscribe: \"subscriptionIds\" must be a list"};
  UnsubscribeRequest request;
  for (const json& item : *items) {
    const std::optional<std::uint32_t> subscription = Id(item);
    if (!subscription) return Error{"unsubscribe: \"subscriptionIds\" must hold numbers from 0 to 2^32 - 1"};
    request.subscriptions.push_back(*subscription);
  }
  return ClientRequest(std::move(request));
}

/// The member parameterNames of a request.
Result<std::vector<std::string>> ParseNames(const json& object, const std::string& operation) {
  const json* const names = Array(object, "parameterNames");
  if (names == nullptr) return Error{operation + ": \"parameterNames\" must be a list"};
  std::vector<std::string> texts;
  for (const json& name : *names) {
    if (!name.is_string()) return Error{operation + ": \"parameterNames\" must hold texts"};
    texts.push_back(name.get<std::string>());
  }
  return texts;
}

Result<ClientRequest> ParseGetParameters(const json& object) {
  Result<std::vector<std::string>> names = ParseNames(object, "getParameters");
  if (!names) return Error{names.error()};
  return ClientRequest(GetParametersRequest{*std::move(names), Text(object, "id")});
}

Result<ClientRequest> ParseParameterUpdates(const json& object, const std::string& operation) {
  Result<std::vector<std::string>> names = ParseNames(object, operation);
  if (!names) return Error{names.error()};
  return ClientRequest(ParameterUpdatesRequest{operation == "subscribeParameterUpdates", *std::move(names)});
}

Result<ClientRequest> ParseSetParameters(const json& object) {
  const json* const items = Array(object, "parameters");
  if (items == nullptr) return Error{"setParameters: \"parameters\" must be a list"};
  SetParametersRequest request;
  for (const json& item : *items) {
    std::string name = item.is_object() ? Text(item, "name") : std::string();
    if (name.empty()) return Error{"setParameters: each parameter must have a \"name\" that is a text"};
    const auto value = item.find("value");  // none = the parameter is to be deleted
    request.items.push_back({std::move(name), value == item.end() ? "null" : Dump(*value)});
  }
  request.id = Text(object, "id");
  return ClientRequest(std::move(request));
}

Result<ClientRequest> ParseClientAdvertise(const json& object) {
  const json* const items = Array(object, "channels");
  if (items == nullptr) return Error{"advertise: \"channels\" must be a list"};
  ClientAdvertiseRequest request;
  for (const json& item : *items) {
    const bool is_object = item.is_object() && item.contains("id");
    const std::optional<std::uint32_t> channel = is_object ? Id(item["id"]) : std::nullopt;
    if (!channel) return Error{"advertise: each channel must have an \"id\", a number from 0 to 2^32 - 1"};
    request.items.push_back({*channel, Text(item, "topic"), Text(item, "encoding")});
  }
  return ClientRequest(std::move(request));
}

Result<ClientRequest> ParseClientUnadvertise(const json& object) {
  const json* const items = Array(object, "channelIds");
  if (items == nullptr) return Error{"unadvertise: \"channelIds\" must be a list"};
  ClientUnadvertiseRequest request;
  for (const json& item : *items) {
    const std::optional<std::uint32_t> channel = Id(item);
    if (!channel) return Error{"unadvertise: \"channelIds\" must hold numbers from 0 to 2^32 - 1"};
    request.channels.push_back(*channel);
  }
  return ClientRequest(std::move(request));
}

std::uint32_t LittleEndian32(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < sizeof(value); ++k) value |= std::uint32_t{bytes[at + k]} << (8 * k);
  return value;
}

Result<ClientRequest> ParseClientMessage(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHead = 5;
  if (bytes.size() < kHead) return Error{"the message's frame is shorter than its channel id"};
  return ClientRequest(ClientMessage{LittleEndian32(bytes, 1), {bytes.begin() + kHead, bytes.end()}});
}

Result<ClientRequest> ParseServiceCall(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHead = 13;
  if (bytes.size() < kHead) return Error{"the service call is shorter than its ids"};
  const std::size_t encoding = LittleEndian32(bytes, 9);
  if (encoding > bytes.size() - kHead) return Error{"the service call is shorter than its encoding's name"};
  const std::string rest(bytes.begin() + kHead, bytes.end());
  return ClientRequest(ServiceCall{LittleEndian32(bytes, 1), LittleEndian32(bytes, 5),
                                   rest.substr(0, encoding), rest.substr(encoding)});
}

/// The binary frames of services begin alike, from the server and from the client.
Frame ServiceFrame(std::uint8_t operation, std::uint32_t service, std::uint32_t call,
                   std::string_view encoding, std::string_view payload) {
  Frame frame{true, {}, nullptr};
  frame.head.push_back(static_cast<char>(operation));
  AppendLittleEndian(frame.head, service);
  AppendLittleEndian(frame.head, call);
  AppendLittleEndian(frame.head, static_cast<std::uint32_t>(encoding.size()));
  frame.head.append(encoding).append(payload);
  return frame;
}

Frame WriteServices() {
  json list = json::array();
  std::uint32_t id = 0;
  for (const CommandService& service : CommandServices()) {
    const std::string name = NameOf(service);
    const std::string type = "thalweg" + name;
    const std::string request = RequestSchema(service);
    const auto format = [](const std::string& schema_name, const std::string& schema) {
      return json{{"encoding", "json"},
                  {"schemaName", schema_name},
                  {"schemaEncoding", "jsonschema"},
                  {"schema", schema}};
    };
    // Earlier clients know only the schemas without their encodings
    list.push_back({{"id", ++id},
                    {"name", name},
                    {"type", type},
                    {"request", format(type + "_request", request)},
                    {"requestSchema", request},
                    {"response", format("thalweg/operator/reply", ReplySchema())},
                    {"responseSchema", ReplySchema()}});
  }
  return TextFrame({{"op", "advertiseServices"}, {"services", list}});
}

}  // namespace

Frame ServerInfo(std::string_view name, std::string_view session, const Capabilities& capabilities) {
  json list = json::array({"parameters", "parametersSubscribe", "connectionGraph"});
  json encodings = json::array();
  if (capabilities.time) list.push_back("time");
  if (capabilities.steer) {
    list.insert(list.end(), {"clientPublish", "services"});
    encodings = {"json", "cdr"};
  }
  return TextFrame({{"op", "serverInfo"},
                    {"name", name},
                    {"capabilities", list},
                    {"supportedEncodings", encodings},
                    {"metadata", json::object()},
                    {"sessionId", session}});
}

Frame Advertise(const std::vector<Channel>& channels) {
  json list = json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", channel.encoding},
                    {"schemaName", channel.schema_name},
                    {"schema", channel.schema},
                    {"schemaEncoding", channel.schema_encoding}});
  }
  return TextFrame({{"op", "advertise"}, {"channels", list}});
}

Frame AdvertiseServices() {
  static const Frame same_for_all = WriteServices();
  return same_for_all;
}

Frame Status(StatusLevel level, std::string_view message, std::string_view id) {
  json frame = {{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}};
  if (!id.empty()) frame["id"] = id;
  return TextFrame(frame);
}

Frame ServiceResponse(std::uint32_t service, std::uint32_t call, std::string_view response) {
  return ServiceFrame(3, service, call, "json", response);
}

Frame ServiceCallFailure(std::uint32_t service, std::uint32_t call, std::string_view reason) {
  return TextFrame(
      {{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", reason}});
}

Frame ParameterValues(const std::vector<Parameter>& parameters, std::string_view id) {
  json list = json::array();
  for (const Parameter& parameter : parameters) {
    json value = json::parse(parameter.value, nullptr, false);
    list.push_back(
        {{"name", parameter.name}, {"value", value.is_discarded() ? json(parameter.value) : value}});
  }
  json frame = {{"op", "parameterValues"}, {"parameters", list}};
  if (!id.empty()) frame["id"] = id;
  return TextFrame(frame);
}

Frame ConnectionGraphUpdate(const ConnectionGraph& before, const ConnectionGraph& now) {
  using NodesByName = std::map<std::string, ConnectionGraph::Nodes>;
  const auto changed = [](const NodesByName& old, const NodesByName& current, const char* nodes_are) {
    json list = json::array();
    for (const auto& [name, nodes] : current) {
      const auto found = old.find(name);
      if (found == old.end() || found->second != nodes) list.push_back({{"name", name}, {nodes_are, nodes}});
    }
    return list;
  };
  json update = {{"op", "connectionGraphUpdate"},
                 {"publishedTopics", changed(before.publishers, now.publishers, "publisherIds")},
                 {"subscribedTopics", changed(before.subscribers, now.subscribers, "subscriberIds")},
                 {"advertisedServices", changed(before.providers, now.providers, "providerIds")},
                 {"removedServices", json::array()}};
  // A topic that has lost its publishers or its subscribers, but not both, is not gone.
  std::set<std::string> removed;
  const auto note_loss = [&](const NodesByName& old, const NodesByName& current, const NodesByName& others,
                             const char* list, const char* nodes_are) {
    for (const auto& [name, nodes] : old) {
      if (current.contains(name)) continue;
      if (others.contains(name)) {
        update[list].push_back({{"name", name}, {nodes_are, json::array()}});
      } else {
        removed.insert(name);
      }
    }
  };
  note_loss(before.publishers, now.publishers, now.subscribers, "publishedTopics", "publisherIds");
  note_loss(before.subscribers, now.subscribers, now.publishers, "subscribedTopics", "subscriberIds");
  update["removedTopics"] = removed;
  for (const auto& [name, nodes] : before.providers) {
    if (!now.providers.contains(name)) update["removedServices"].push_back(name);
  }
  return TextFrame(update);
}

Frame TimeFrame(Time now) {
  Frame frame{true, {}, nullptr};
  frame.head.push_back(2);
  AppendLittleEndian(frame.head, static_cast<std::uint64_t>(now.time_since_epoch().count()));
  return frame;
}

Frame MessageData(std::uint32_t subscription, Time stamp, Bytes message) {
  Frame frame{true, {}, std::move(message)};
  frame.head.push_back(1);
  AppendLittleEndian(frame.head, subscription);
  AppendLittleEndian(frame.head, static_cast<std::uint64_t>(stamp.time_since_epoch().count()));
  return frame;
}

Result<ClientRequest> ParseText(std::string_view text) {
  if (text.size() > kMaxClientFrame) return Error{"the frame is longer than 256 KiB"};
  const std::optional<json> parsed = ParseObject(text);
  if (!parsed) return Error{"the frame is not a JSON object"};
  const json& object = *parsed;
  const std::string operation = Text(object, "op");
  if (operation.empty()) return Error{"the frame has no \"op\" that is a text"};
  if (operation == "subscribe") return ParseSubscribe(object);
  if (operation == "unsubscribe") return ParseUnsubscribe(object);
  if (operation == "getParameters") return ParseGetParameters(object);
  if (operation == "advertise") return ParseClientAdvertise(object);
  if (operation == "unadvertise") return ParseClientUnadvertise(object);
  if (operation == "setParameters") return ParseSetParameters(object);
  if (operation == "subscribeParameterUpdates" || operation == "unsubscribeParameterUpdates") {
    return ParseParameterUpdates(object, operation);
  }
  if (operation == "subscribeConnectionGraph") return ClientRequest(ConnectionGraphRequest{true});
  if (operation == "unsubscribeConnectionGraph") return ClientRequest(ConnectionGraphRequest{false});
  constexpr std::size_t kLongestQuoted = 40;
  return ClientRequest(UnofferedRequest{operation.substr(0, kLongestQuoted)});
}

Result<ClientRequest> ParseBinary(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Error{"the binary frame is empty"};
  switch (bytes[0]) {
    case 1:
      return ParseClientMessage(bytes);
    case 2:
      return ParseServiceCall(bytes);
    default:
      return Error{"the binary frame has the unknown operation " + std::to_string(bytes[0])};
  }
}

}  // namespace thalweg::gateway
