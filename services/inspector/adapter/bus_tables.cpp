#include "services/inspector/adapter/bus_tables.h"

#include <algorithm>
#include <tuple>

#include "common/base/text.h"
#include "common/dds/schema.h"

namespace thalweg::inspector {
namespace {

std::string Or(const std::string& text, const std::string& otherwise) {
  return text.empty() ? otherwise : CleanText(text);
}

std::string PlaceOf(const dds::Participant& node) {
  return Or(node.host, Or(node.address, "this machine"));
}

std::string ProgramOf(const dds::Participant& node) {
  if (node.is_discovery_server) return node.vendor + ", discovery server";
  return node.version.empty() ? node.vendor : "thalweg " + CleanText(node.version) + ", " + node.vendor;
}

}  // namespace

std::map<std::string, TopicUse> TopicUses(const dds::BusGraph& graph) {
  std::map<std::string, TopicUse> uses;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    TopicUse& use = uses[dds::ShownTopic(endpoint.topic)];
    use.types.insert(CleanText(dds::Ros2TypeName(endpoint.type)));
    (endpoint.writes ? use.writers : use.readers).push_back(&endpoint);
  }
  return uses;
}

std::string QosText(const dds::Endpoint& endpoint) {
  std::string text = dds::TextOf(endpoint.qos);
  for (const std::string& partition : endpoint.partitions) text += ", partition " + CleanText(partition);
  return text;
}

std::vector<const dds::Participant*> NodesByName(const dds::BusGraph& graph) {
  std::vector<const dds::Participant*> nodes;
  for (const dds::Participant& node : graph.participants) nodes.push_back(&node);
  std::ranges::sort(nodes, {}, [](const dds::Participant* node) {
    return std::tie(node->name, node->host, node->process, node->id);
  });
  return nodes;
}

Rows NodeRows(const dds::BusGraph& graph) {
  Rows rows = {{"NODE", "HOST", "PROCESS", "ADDRESS", "PROGRAM", "PUBLISHES", "SUBSCRIBES"}};
  for (const dds::Participant* const node : NodesByName(graph)) {
    const auto count = [&](bool writes) {
      return std::to_string(std::ranges::count_if(graph.endpoints, [&](const dds::Endpoint& endpoint) {
        return endpoint.participant == node->id && endpoint.writes == writes;
      }));
    };
    rows.push_back({Or(node->name, "(no name)"), PlaceOf(*node), Or(node->process, "?"),
                    Or(node->address, "-"), ProgramOf(*node), count(true), count(false)});
  }
  return rows;
}

std::string NodeText(const dds::Participant& node) {
  const std::string address = node.address.empty() || node.host.empty() ? "" : " (" + node.address + ')';
  return CleanText(node.name) + ": process " + Or(node.process, "unknown") + " on " + PlaceOf(node) +
         address + ", " + ProgramOf(node);
}

Rows EndpointRows(const dds::BusGraph& graph, const dds::Participant& node, bool writes) {
  Rows rows;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (endpoint.participant != node.id || endpoint.writes != writes) continue;
    rows.push_back({"    " + dds::ShownTopic(endpoint.topic), CleanText(dds::Ros2TypeName(endpoint.type)),
                    QosText(endpoint)});
  }
  std::ranges::sort(rows);
  if (rows.empty()) rows.push_back({"    nothing"});
  return rows;
}

std::vector<dds::Mismatch> MismatchesOf(const dds::BusGraph& graph, const std::string& node) {
  std::vector<dds::Mismatch> mismatches = dds::FindMismatches(graph);
  std::erase_if(mismatches, [&](const dds::Mismatch& mismatch) {
    return !node.empty() && mismatch.text.find('"' + node + '"') == std::string::npos;
  });
  return mismatches;
}

}  // namespace thalweg::inspector
