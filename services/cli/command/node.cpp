#include <iostream>
#include <memory>
#include <stdexcept>

#include "common/base/text.h"
#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/bus_tables.h"
#include "services/inspector/adapter/survey.h"

namespace thalweg::cli {
namespace {

struct NodeArgs {
  NetworkArgs network;
  std::string node;
};

dds::BusGraph GraphOf(const NetworkArgs& network) {
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(network));
  return inspector::Survey(bus, stop);
}

/// Prints the mismatches, of one node's name or of all; returns the exit code.
int PrintMismatches(const dds::BusGraph& graph, const std::string& name) {
  const std::vector<dds::Mismatch> mismatches = inspector::MismatchesOf(graph, name);
  for (const dds::Mismatch& mismatch : mismatches) {
    std::cout << "problem  " << mismatch.topic << ": " << mismatch.text << "\n         -> " << mismatch.advice
              << '\n';
  }
  return mismatches.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

int ListNodes(const NodeArgs& args) {
  const dds::BusGraph graph = GraphOf(args.network);
  if (graph.participants.empty()) {
    ReportEmptyDomain(args.network);
    return EXIT_SUCCESS;
  }
  std::cout << inspector::TableText(inspector::NodeRows(graph));
  return PrintMismatches(graph, "");
}

int DescribeNode(const NodeArgs& args) {
  const dds::BusGraph graph = GraphOf(args.network);
  bool found = false;
  std::string names;
  for (const dds::Participant* const node : inspector::NodesByName(graph)) {
    names += (names.empty() ? "" : ", ") + CleanText(node->name);
    if (node->name != args.node) continue;
    found = true;
    std::cout << inspector::NodeText(*node) << "\n  publishes\n"
              << inspector::TableText(inspector::EndpointRows(graph, *node, true)) << "  subscribes\n"
              << inspector::TableText(inspector::EndpointRows(graph, *node, false));
  }
  if (!found) {
    throw std::runtime_error("there is no node " + args.node +
                             (names.empty() ? ", nor any other" : "; the nodes are " + names));
  }
  return PrintMismatches(graph, args.node);
}

}  // namespace

void AddNode(CLI::App& app, int& exit_code) {
  CLI::App* const node = app.add_subcommand("node", "Look at the processes on the bus: list, info");
  node->require_subcommand(1);
  const auto args = std::make_shared<NodeArgs>();
  CLI::App* const list =
      node->add_subcommand("list", "List who is on the bus, and what does not fit together");
  AddNetworkArgs(*list, args->network);
  list->callback([args, &exit_code] { exit_code = ListNodes(*args); });
  CLI::App* const info =
      node->add_subcommand("info", "Print what a node publishes and subscribes, with which QoS");
  info->add_option("node", args->node, "Name, as list prints it")->required();
  AddNetworkArgs(*info, args->network);
  info->callback([args, &exit_code] { exit_code = DescribeNode(*args); });
}

}  // namespace thalweg::cli
