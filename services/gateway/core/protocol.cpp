#include "services/gateway/core/protocol.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace thalweg::gateway {
namespace {

using nlohmann::json;

/// Names from the wire may hold bytes that are not UTF-8, which must not throw when they are quoted.
std::string Dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

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

Result<ClientRequest> ParseGetParameters(const json& object) {
  const json* const names = Array(object, "parameterNames");
  if (names == nullptr) return Error{"getParameters: \"parameterNames\" must be a list"};
  GetParametersRequest request;
  for (const json& name : *names) {
    if (!name.is_string()) return Error{"getParameters: \"parameterNames\" must hold texts"};
    request.names.push_back(name.get<std::string>());
  }
  request.id = Text(object, "id");
  return ClientRequest(std::move(request));
}

}  // namespace

Frame ServerInfo(std::string_view name, std::string_view session, bool with_time) {
  json capabilities = json::array({"parameters"});
  if (with_time) capabilities.push_back("time");
  return TextFrame({{"op", "serverInfo"},
                    {"name", name},
                    {"capabilities", capabilities},
                    {"supportedEncodings", json::array()},
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

Frame Status(StatusLevel level, std::string_view message) {
  return TextFrame({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
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
  // Deep nesting is refused before the parser's result is torn down recursively.
  constexpr int kMaxDepth = 16;
  const auto limit = [](int depth, json::parse_event_t, json&) { return depth <= kMaxDepth; };
  const json object = json::parse(text, limit, false);
  if (object.is_discarded() || !object.is_object()) return Error{"the frame is not a JSON object"};
  const std::string operation = Text(object, "op");
  if (operation.empty()) return Error{"the frame has no \"op\" that is a text"};
  if (operation == "subscribe") return ParseSubscribe(object);
  if (operation == "unsubscribe") return ParseUnsubscribe(object);
  if (operation == "getParameters") return ParseGetParameters(object);
  if (operation == "setParameters") return ClientRequest(SetParametersRequest{Text(object, "id")});
  // Parameters never change, so that there is nothing to notify a client of.
  if (operation == "subscribeParameterUpdates" || operation == "unsubscribeParameterUpdates") {
    return ClientRequest(UnsubscribeRequest{});
  }
  constexpr std::size_t kLongestQuoted = 40;
  return ClientRequest(UnofferedRequest{operation.substr(0, kLongestQuoted)});
}

Result<ClientRequest> ParseBinary(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Error{"the binary frame is empty"};
  switch (bytes[0]) {
    case 1:
      return ClientRequest(UnofferedRequest{"client message data"});
    case 2:
      return ClientRequest(UnofferedRequest{"service call"});
    default:
      return Error{"the binary frame has the unknown operation " + std::to_string(bytes[0])};
  }
}

}  // namespace thalweg::gateway
