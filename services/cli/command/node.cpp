#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "common/base/text.h"
#include "common/dds/schema.h"
#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/survey.h"

namespace thalweg::cli {
namespace {

struct Args {
  NetworkArgs network;
  std::string node;
};

dds::BusGraph GraphOf(const NetworkArgs& network) {
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(network));
  dds::BusGraph graph = inspector::Survey(bus, stop);
  std::ranges::sort(graph.participants, [](const dds::Participant& a, const dds::Participant& b) {
    return std::tie(a.name, a.host, a.process, a.id) < std::tie(b.name, b.host, b.process, b.id);
  });
  return graph;
}

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

/// Prints rows in columns, each as wide as its widest cell.
void PrintTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows[0].size());
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) line += fmt::format("{:<{}}  ", row[k], widths[k]);
    line.erase(line.find_last_not_of(' ') + 1);
    std::cout << line << '\n';
  }
}

/// Prints the mismatches, of one node's name or of all; returns whether there are any.
bool PrintMismatches(const dds::BusGraph& graph, const std::string& name) {
  bool any = false;
  for (const dds::Mismatch& mismatch : dds::FindMismatches(graph)) {
    if (!name.empty() && mismatch.text.find('"' + name + '"') == std::string::npos) continue;
    any = true;
    std::cout << "problem  " << mismatch.topic << ": " << mismatch.text << "\n         -> " << mismatch.advice
              << '\n';
  }
  return any;
}

int List(const Args& args) {
  const dds::BusGraph graph = GraphOf(args.network);
  if (graph.participants.empty()) {
    std::cerr << "thalweg: nobody else is in DDS domain " << SurveyOptionsFrom(args.network).domain
              << "; --domain names another one, thalweg doctor shows which are in use\n";
    return EXIT_SUCCESS;
  }
  std::vector<std::vector<std::string>> rows = {
      {"NODE", "HOST", "PROCESS", "ADDRESS", "PROGRAM", "PUBLISHES", "SUBSCRIBES"}};
  for (const dds::Participant& node : graph.participants) {
    const auto count = [&](bool writes) {
      return std::to_string(std::ranges::count_if(graph.endpoints, [&](const dds::Endpoint& endpoint) {
        return endpoint.participant == node.id && endpoint.writes == writes;
      }));
    };
    rows.push_back({Or(node.name, "(no name)"), PlaceOf(node), Or(node.process, "?"), Or(node.address, "-"),
                    ProgramOf(node), count(true), count(false)});
  }
  PrintTable(rows);
  return PrintMismatches(graph, "") ? EXIT_FAILURE : EXIT_SUCCESS;
}

void PrintEndpoints(const dds::BusGraph& graph, const dds::Participant& node, bool writes) {
  std::cout << (writes ? "  publishes\n" : "  subscribes\n");
  std::vector<std::vector<std::string>> rows;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    if (endpoint.participant != node.id || endpoint.writes != writes) continue;
    std::string qos = dds::TextOf(endpoint.qos);
    for (const std::string& partition : endpoint.partitions) qos += ", partition " + CleanText(partition);
    rows.push_back({"    " + CleanText(dds::TopicName(endpoint.topic).value_or(endpoint.topic)),
                    CleanText(dds::Ros2TypeName(endpoint.type)), qos});
  }
  std::ranges::sort(rows);
  if (rows.empty()) rows.push_back({"    nothing"});
  PrintTable(rows);
}

int Info(const Args& args) {
  const dds::BusGraph graph = GraphOf(args.network);
  bool found = false;
  for (const dds::Participant& node : graph.participants) {
    if (node.name != args.node) continue;
    found = true;
    std::cout << fmt::format("{}: process {} on {}", CleanText(node.name), Or(node.process, "unknown"),
                             PlaceOf(node));
    if (!node.address.empty() && !node.host.empty()) std::cout << " (" << node.address << ')';
    std::cout << ", " << ProgramOf(node) << '\n';
    PrintEndpoints(graph, node, true);
    PrintEndpoints(graph, node, false);
  }
  if (!found) {
    std::string names;
    for (const dds::Participant& node : graph.participants)
      names += (names.empty() ? "" : ", ") + CleanText(node.name);
    throw std::runtime_error("there is no node " + args.node + "; the nodes are " + Or(names, "none"));
  }
  return PrintMismatches(graph, args.node) ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace

void AddNode(CLI::App& app, int& exit_code) {
  CLI::App* const node = app.add_subcommand("node", "Look at the processes on the bus: list, info");
  node->require_subcommand(1);
  const auto args = std::make_shared<Args>();
  CLI::App* const list =
      node->add_subcommand("list", "List who is on the bus, and what does not fit together");
  AddNetworkArgs(*list, args->network);
  list->callback([args, &exit_code] { exit_code = List(*args); });
  CLI::App* const info =
      node->add_subcommand("info", "Print what a node publishes and subscribes, with which QoS");
  info->add_option("node", args->node, "Name, as list prints it")->required();
  AddNetworkArgs(*info, args->network);
  info->callback([args, &exit_code] { exit_code = Info(*args); });
}

}  // namespace thalweg::cli
