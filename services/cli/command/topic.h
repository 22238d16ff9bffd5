#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <stop_token>
#include <string>

#include "common/dds/bus.h"
#include "services/cli/command/network_args.h"
#include "services/inspector/adapter/open_topic.h"

namespace thalweg::cli {

/// What all commands of `thalweg topic` have in common.
struct TopicArgs {
  NetworkArgs network;
  std::string topic;
  std::string type;  ///< Empty = as the table of topics or the bus says.
};

// Each function adds one command of `thalweg topic`.
void AddTopicEcho(CLI::App& topic, int& exit_code);
void AddTopicMeters(CLI::App& topic, int& exit_code);  ///< hz, bw, delay
void AddTopicPub(CLI::App& topic, int& exit_code);

void AddTopicArgs(CLI::App& command, TopicArgs& args);

/// Lets a command that prints for ever see that nobody reads it any more, as behind `| head`, and end in
/// order.
void EndWithReader();

/// A bus that learns of everybody in its domain.
dds::BusOptions SurveyOptionsFrom(const NetworkArgs& args);

/// Says on stderr that the domain is empty, and what to try.
void ReportEmptyDomain(const NetworkArgs& args);

/// The topic that a person named, from the table or else from who is on the bus, which takes some seconds.
/// Throws std::runtime_error.
inspector::OpenTopic OpenTopicFrom(const TopicArgs& args, dds::Bus& bus, const std::stop_token& stop);

}  // namespace thalweg::cli
