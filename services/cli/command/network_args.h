#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/dds/bus.h"
#include "common/scenario/scenario.h"

namespace thalweg::cli {

/// Where the bus is, for commands that join it without being part of a run.
struct NetworkArgs {
  std::string scenario = kDefaultScenario;  ///< Name or file; its block `network` counts.
  int domain = -1;                          ///< -1 = from THALWEG_DOMAIN or the scenario.
};
void AddNetworkArgs(CLI::App& command, NetworkArgs& args);

/// Adds --domain. @param more  What a command's help says beyond what the option overrides; may be empty.
void AddDomainOption(CLI::App& command, int& domain, const std::string& more = {});

/// A bus that is no part of a run: it reports no health and keeps the system's time. Until the command opens
/// topics it uses none, so that all can be used undecoded.
dds::BusOptions BusOptionsFrom(const NetworkArgs& args, const std::string& name);
/// Likewise, with the network of a scenario that has been loaded. @param domain  As NetworkArgs::domain.
dds::BusOptions BusOptionsFrom(const Scenario& scenario, int domain, const std::string& name);

}  // namespace thalweg::cli
