#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "common/scenario/scenario.h"

namespace thalweg {

/// Whether a service leaves files in --out. All take the option, so that all can be started alike.
enum class Files { kWritten, kNone };

/// What every service takes on its command line:
/// --scenario NAME|FILE [--set field=value ...] [--domain N] [--out DIR].
struct ServiceArgs {
  std::string scenario = "kitchen";  ///< THALWEG_SCENARIO is the default, when set.
  std::vector<std::string> overrides;
  int domain = -1;        ///< -1 = the scenario's, or THALWEG_DOMAIN.
  std::string out = ".";  ///< Where files go.
  Files files = Files::kWritten;
};

/// Exits on --help (0) and on a mistake (2), which it tells. Sets up logging under `name`.
ServiceArgs ParseServiceArgs(int argc, char** argv, const std::string& name, Files files = Files::kWritten);

/// Log lines go to stderr: [time] [name] [level] text.
void SetUpLog(const std::string& name);

/// Asked to stop by SIGINT or SIGTERM; asked a second time, the process ends at once. Call once, before any
/// thread starts. Both signals stay blocked: whoever starts a process must unblock them in the child.
std::stop_token StopOnSignals();

/// Name, network, clock and domain for a service, and what it says of itself at the start: command line, then
/// environment (THALWEG_DOMAIN, THALWEG_PARTITION, THALWEG_INTERFACE, THALWEG_DISCOVERY_SERVER), then
/// scenario.
dds::BusOptions BusOptionsFrom(const Scenario& scenario, const ServiceArgs& args, const std::string& name);

}  // namespace thalweg
