#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/dds/bus.h"
#include "common/scenario/scenario.h"

namespace CLI {
class App;
}

namespace thalweg {

/// Whether a service writes files to --out. All services accept the option, so that all can be started alike.
enum class Files { kWritten, kNone };

/// The command line of every service: --scenario NAME|FILE [--set field=value ...] [--domain N] [--out DIR]
/// [--healthy].
struct ServiceArgs {
  std::string scenario = kDefaultScenario;  ///< Overridden by THALWEG_SCENARIO if that is set.
  std::vector<std::string> overrides;
  int domain = -1;        ///< -1 = from THALWEG_DOMAIN or the scenario.
  std::string out = ".";  ///< Folder of the files that the service writes.
  Files files = Files::kWritten;
};

/// Parses the command line and sets up logging under `name`. Exits after --help (0), after --healthy (0 if
/// the copy of this service that runs on this machine works, 1 otherwise) and, with a message, on an error
/// (2). Throws std::runtime_error, before any work, if the service writes files and cannot write to
/// --out, which is created if needed.
/// @param summary  What the service does, for --help: "NAME: SUMMARY."
/// @param add_options  Adds options of the service's own.
/// @param name_on_bus  Returns the name under which the running copy is on the bus, if options decide it.
ServiceArgs ParseServiceArgs(int argc, char** argv, const std::string& name, const std::string& summary,
                             Files files = Files::kWritten,
                             const std::function<void(CLI::App&)>& add_options = {},
                             const std::function<std::string()>& name_on_bus = {});

/// Sends log lines to stderr, as [time] [name] [level] text, and to the bus of BusOptionsFrom.
void SetUpLog(const std::string& name);

/// Returns a token whose stop is requested by SIGINT, SIGTERM or, unless it is ignored, SIGHUP; a second
/// signal ends the process at once. Call once, before any thread is started. These signals stay blocked, so
/// code that starts a process must unblock them in the child.
std::stop_token StopOnSignals();

void Visit(OptionVisitor& visitor, dds::BusOptions& options);  ///< Block `network`.
void Visit(OptionVisitor& visitor, dds::TopicNames& names);    ///< Block `topics`.
void Visit(OptionVisitor& visitor, dds::FrameNames& names);    ///< Block `frames`.
struct RobotName {
  std::string name;
};
void Visit(OptionVisitor& visitor, RobotName& robot);  ///< Part of block `robot`.
/// The names on the wire as stated in the scenario.
dds::Names NamesFrom(const Scenario& scenario);
/// The network as stated in the scenario, without command line and environment.
dds::BusOptions NetworkFrom(const Scenario& scenario);

/// Name, network, clock and domain of a service, and the description it logs at start. Precedence: command
/// line, then environment (THALWEG_DOMAIN, THALWEG_PARTITION, THALWEG_INTERFACE, THALWEG_DISCOVERY_SERVER,
/// THALWEG_PEERS, THALWEG_LOCAL_ONLY, THALWEG_SECURITY), then scenario. The service is the only one of its
/// name (BusOptions::sole).
dds::BusOptions BusOptionsFrom(const Scenario& scenario, const ServiceArgs& args, const std::string& name);

}  // namespace thalweg
