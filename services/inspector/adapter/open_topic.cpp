#include "services/inspector/adapter/open_topic.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/nearest_name.h"
#include "common/base/text.h"
#include "common/dds/schema.h"
#include "services/inspector/adapter/message_definitions.h"

namespace thalweg::inspector {
namespace {

/// "nav_msgs/msg/Odometry" for "nav_msgs/Odometry".
std::string FullType(const std::string& type) {
  const std::size_t slash = type.find('/');
  if (slash == std::string::npos || type.find("/msg/") != std::string::npos) return type;
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

/// Types that are published or subscribed under the topic's name.
std::set<std::string> TypesOf(const std::string& topic, const dds::BusGraph& graph) {
  std::set<std::string> types;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (endpoint.topic == dds::WireTopic(topic)) types.insert(dds::Ros2TypeName(endpoint.type));
  }
  return types;
}

/// The QoS of a reader which all writers of the topic satisfy; what `otherwise` says if there is none.
dds::Delivery DeliveryFrom(const std::string& topic, const dds::BusGraph& graph, dds::Delivery otherwise) {
  bool any = false;
  bool reliable = true;
  bool kept = true;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (!endpoint.writes || endpoint.topic != dds::WireTopic(topic)) continue;
    any = true;
    reliable = reliable && endpoint.qos.reliable;
    kept = kept && endpoint.qos.durability >= dds::Durability::kTransientLocal;
  }
  if (!any) return otherwise;
  if (!reliable) return dds::Delivery::kSamples;  // read as best effort
  return kept ? dds::Delivery::kState : dds::Delivery::kLog;
}

std::string Joined(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + CleanText(name);
  return text;
}

/// The type that is asked for, that of the table, or the only one on the bus.
Result<std::string> TypeFor(const std::string& topic, const std::string& asked, const dds::TopicInfo* known,
                            const dds::BusGraph& graph) {
  std::set<std::string> types = TypesOf(topic, graph);
  if (!asked.empty()) {
    const std::string type = FullType(asked);
    if (types.empty() && known != nullptr) types.insert(dds::Ros2TypeName(known->type_name));
    if (types.empty() || types.contains(type)) return type;
    return Error{fmt::format("{} carries {}, not {}", topic, Joined(types), type)};
  }
  if (known != nullptr) return dds::Ros2TypeName(known->type_name);
  if (types.size() == 1) return *types.begin();
  if (types.size() > 1) {
    return Error{
        fmt::format("topic {} is used with several types: {}; choose one with --type", topic, Joined(types))};
  }
  std::set<std::string> topics;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (const auto name = dds::TopicName(endpoint.topic)) topics.insert(*name);
  }
  const std::string others = topics.empty() ? "there is nobody on this bus (is it the right --domain?)"
                                            : "the topics of this bus are " + Joined(topics);
  for (const dds::TopicInfo& of_table : dds::AllTopics()) topics.insert(of_table.name);
  return Error{fmt::format("nobody publishes or subscribes to {}; {}{}", topic, others,
                           DidYouMean({topics.begin(), topics.end()}, topic))};
}

}  // namespace

std::string TopicNameFrom(const std::string& name) {
  const std::string bare = name.starts_with('/') ? name.substr(1) : name;
  return dds::TopicName(bare).value_or(bare);
}

bool IsInTable(const std::string& topic) {
  return dds::FindTopic(TopicNameFrom(topic)) != nullptr;
}

Result<OpenTopic> FindOpenTopic(const std::string& topic, const std::string& type, const dds::BusGraph& graph,
                                const std::vector<std::filesystem::path>& folders) {
  const std::string name = TopicNameFrom(topic);
  const dds::TopicInfo* const known = dds::FindTopic(name);
  const auto found = TypeFor(name, type, known, graph);
  if (!found) return Error{found.error()};
  const Result<std::string> text = MessageDefinition(*found, folders);
  if (!text) return Error{CleanText(fmt::format("{} carries {}: {}", name, *found, text.error()))};
  auto schema = Schema::Parse(*found, *text);
  if (!schema) return Error{schema.error()};
  const auto otherwise = known != nullptr ? known->delivery : dds::Delivery::kSamples;
  return OpenTopic{.info = {.name = name,
                            .type_name = dds::WireTypeName(*found),
                            .delivery = DeliveryFrom(name, graph, otherwise),
                            .writers = dds::Writers::kMany,
                            .most_bytes = known != nullptr ? known->most_bytes : dds::kMostMapBytes},
                   .type = *found,
                   .definition = *text,
                   .schema = *std::move(schema)};
}

std::set<std::string> OtherHostsOf(const std::string& topic, const dds::BusGraph& graph,
                                   const std::string& own_host) {
  std::set<std::string> hosts;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (!endpoint.writes || endpoint.topic != dds::WireTopic(TopicNameFrom(topic))) continue;
    const dds::Participant* const writer = graph.Find(endpoint.participant);
    if (writer != nullptr && !writer->host.empty() && writer->host != own_host)
      hosts.insert(CleanText(writer->host));
  }
  return hosts;
}

std::set<std::string> WritersOf(const std::string& topic, const dds::BusGraph& graph) {
  std::set<std::string> writers;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (endpoint.writes && endpoint.topic == dds::WireTopic(TopicNameFrom(topic)))
      writers.insert(graph.NameOf(endpoint.participant));
  }
  return writers;
}

std::string WhyNothingArrives(const std::string& topic, const dds::BusGraph& graph) {
  const std::string name = TopicNameFrom(topic);
  const std::set<std::string> writers = WritersOf(name, graph);
  if (!writers.empty())
    return fmt::format("{} is published by {}, but nothing has come yet", name, Joined(writers));
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (!endpoint.writes || endpoint.topic != name) continue;
    return fmt::format(
        "{} publishes {} without the prefix that ROS 2's topics have on the wire: it must be {}",
        graph.NameOf(endpoint.participant), name, dds::WireTopic(name));
  }
  const bool alone = graph.participants.empty();
  return fmt::format("nobody publishes {} yet{}", name, alone ? "; nobody else is in this domain" : "");
}

}  // namespace thalweg::inspector
