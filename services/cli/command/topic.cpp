#include "services/cli/command/topic.h"

#include <fmt/format.h>

#include <csignal>
#include <iostream>
#include <stdexcept>

#include "common/dds/schema.h"
#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/inspector/adapter/bus_tables.h"
#include "services/inspector/adapter/survey.h"

namespace thalweg::cli {
namespace {

struct ListArgs {
  NetworkArgs network;
  bool types = false, counts = false, unused = false;
};

int ListTopics(const ListArgs& args) {
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(args.network));
  const dds::BusGraph graph = inspector::Survey(bus, stop);
  auto uses = inspector::TopicUses(graph);
  if (args.unused) {
    for (const dds::TopicInfo& topic : dds::AllTopics()) {
      uses[topic.name].types.insert(dds::Ros2TypeName(topic.type_name));
    }
  }
  std::size_t width = 0;
  for (const auto& [name, use] : uses) width = std::max(width, name.size());
  for (const auto& [name, use] : uses) {
    if (args.counts) {
      const std::size_t out = use.writers.size();
      const std::size_t in = use.readers.size();
      std::cout << fmt::format("{:<{}}  {:>2} publisher{:1}  {:>2} subscriber{:1}  {}\n", name, width, out,
                               out == 1 ? "" : "s", in, in == 1 ? "" : "s", fmt::join(use.types, ", "));
    } else if (args.types) {
      std::cout << fmt::format("{} [{}]\n", name, fmt::join(use.types, ", "));
    } else {
      std::cout << name << '\n';
    }
  }
  if (graph.participants.empty()) ReportEmptyDomain(args.network);
  return EXIT_SUCCESS;
}

void PrintEndpoints(const std::vector<const dds::Endpoint*>& endpoints, const dds::BusGraph& graph) {
  for (const dds::Endpoint* const endpoint : endpoints) {
    std::cout << "  " << graph.NameOf(endpoint->participant) << ": " << inspector::QosText(*endpoint) << '\n';
  }
}

int DescribeTopic(const TopicArgs& args) {
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(args.network));
  const dds::BusGraph graph = inspector::Survey(bus, stop);
  const std::string name = inspector::TopicNameFrom(args.topic);
  const auto uses = inspector::TopicUses(graph);
  const auto found = uses.find(name);
  if (found == uses.end() && !inspector::IsInTable(name)) {
    const auto topic = inspector::FindOpenTopic(name, "", graph);
    throw std::runtime_error(topic ? "nobody uses " + name : topic.error());
  }
  inspector::TopicUse use = found == uses.end() ? inspector::TopicUse() : found->second;
  if (const dds::TopicInfo* const known = dds::FindTopic(name))
    use.types.insert(dds::Ros2TypeName(known->type_name));
  std::cout << fmt::format("Type: {}\nPublisher count: {}\n", fmt::join(use.types, ", "), use.writers.size());
  PrintEndpoints(use.writers, graph);
  std::cout << fmt::format("Subscription count: {}\n", use.readers.size());
  PrintEndpoints(use.readers, graph);
  int exit_code = EXIT_SUCCESS;
  for (const dds::Mismatch& mismatch : dds::FindMismatches(graph)) {
    if (mismatch.topic != name) continue;
    std::cout << "Problem: " << mismatch.text << "; " << mismatch.advice << '\n';
    exit_code = EXIT_FAILURE;
  }
  return exit_code;
}

void AddTopicList(CLI::App& topic, int& exit_code) {
  const auto args = std::make_shared<ListArgs>();
  CLI::App* const command =
      topic.add_subcommand("list", "List the topics that somebody publishes or subscribes to");
  command->add_flag("-t,--show-types", args->types, "With their types");
  command->add_flag("-v,--verbose", args->counts, "With the numbers of publishers and subscribers");
  command->add_flag("-a,--all", args->unused, "Also the topics of thalweg that nobody uses now");
  AddNetworkArgs(*command, args->network);
  command->callback([args, &exit_code] { exit_code = ListTopics(*args); });
}

void AddTopicInfo(CLI::App& topic, int& exit_code) {
  const auto args = std::make_shared<TopicArgs>();
  CLI::App* const command = topic.add_subcommand(
      "info", "Print a topic's type, who publishes it and subscribes to it, with which QoS");
  command->add_option("topic", args->topic, "Name of the topic")->required();
  AddNetworkArgs(*command, args->network);
  command->callback([args, &exit_code] { exit_code = DescribeTopic(*args); });
}

}  // namespace

void AddTopicArgs(CLI::App& command, TopicArgs& args) {
  command.add_option("topic", args.topic, "Name of the topic")->required();
  command.add_option("--type", args.type,
                     "Its type, such as nav_msgs/msg/Odometry; default: as others use it");
  AddNetworkArgs(command, args.network);
}

void EndWithReader() {
  std::signal(SIGPIPE, SIG_IGN);  // std::cout fails instead
}

dds::BusOptions SurveyOptionsFrom(const NetworkArgs& args) {
  SetUpLog("thalweg");
  dds::BusOptions options = BusOptionsFrom(args, "thalweg");
  options.surveys = true;
  options.names = {};  // topics are shown and asked for as they are called on the wire
  return options;
}

void ReportEmptyDomain(const NetworkArgs& args) {
  std::cerr << "thalweg: nobody else is in DDS domain " << SurveyOptionsFrom(args).domain
            << "; --domain names another one, thalweg doctor shows which are in use\n";
}

inspector::OpenTopic OpenTopicFrom(const TopicArgs& args, dds::Bus& bus, const std::stop_token& stop) {
  dds::BusGraph graph;
  if (!inspector::IsInTable(args.topic) || !args.type.empty()) graph = inspector::Survey(bus, stop);
  auto topic = inspector::FindOpenTopic(args.topic, args.type, graph);
  if (!topic) throw std::runtime_error(topic.error());
  return *std::move(topic);
}

void AddTopic(CLI::App& app, int& exit_code) {
  CLI::App* const topic =
      app.add_subcommand("topic", "Look at topics, and publish: list, info, echo, hz, bw, delay, pub");
  topic->require_subcommand(1);
  AddTopicList(*topic, exit_code);
  AddTopicInfo(*topic, exit_code);
  AddTopicEcho(*topic, exit_code);
  AddTopicMeters(*topic, exit_code);
  AddTopicPub(*topic, exit_code);
}

}  // namespace thalweg::cli
