#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/cli/command/command.h"
#include "services/cli/command/network_args.h"
#include "services/cli/process/browser.h"
#include "services/cli/process/child_process.h"
#include "services/cli/process/port_announcement.h"
#include "services/cli/process/run_programs.h"
#include "services/gateway/adapter/options.h"

namespace thalweg::cli {
namespace {

struct ViewArgs {
  std::string scenario = kDefaultScenario;
  std::vector<std::string> overrides;
  int domain = -1;
  std::string address;
  int port = -1;
  bool read_only = false;
};

void PrintAddress(const gateway::ListenOptions& listen) {
  ShowPage(listen, "in a browser, or the same with ws:// in Foxglove.", isatty(STDOUT_FILENO) != 0,
           [](const std::string& text) {
             std::cout << text << " Ctrl-C ends the view, not the run." << std::endl;
           });
}

/// Becomes the gateway; returns only by an exception.
void ViewRun(const ViewArgs& args) {
  if (!args.address.empty()) setenv("THALWEG_GATEWAY_ADDRESS", args.address.c_str(), 1);
  if (args.port >= 0) setenv("THALWEG_GATEWAY_PORT", std::to_string(args.port).c_str(), 1);
  if (args.read_only) setenv("THALWEG_GATEWAY_READ_ONLY", "1", 1);
  gateway::ListenOptions listen = gateway::ListenOptionsFromEnvironment();
  const std::string announcement = WhenPortIsAnnounced([&](int port) {
    listen.port = port;  // not always that of the environment: another gateway may have it
    PrintAddress(listen);
  });
  Become(ViewProgram({.scenario = args.scenario,
                      .overrides = args.overrides,
                      .domain = args.domain >= 0 ? std::optional(args.domain) : std::nullopt,
                      .announcement = announcement}));
}

}  // namespace

void AddView(CLI::App& app) {
  const auto args = std::make_shared<ViewArgs>();
  CLI::App* command = app.add_subcommand("view", "Show a run that was started elsewhere in the browser");
  command->add_option("scenario", args->scenario, "Name of a scenario in deploy/scenarios, or a file")
      ->envname("THALWEG_SCENARIO")
      ->capture_default_str();
  command->add_option("--set", args->overrides, "field=value, overrides the scenario's")
      ->allow_extra_args(false);
  AddDomainOption(*command, args->domain);
  command->add_option("--address", args->address,
                      "Address to listen on; one that other machines reach needs THALWEG_GATEWAY_TOKEN");
  command
      ->add_option("--port", args->port,
                   "Port to listen on; default: " + std::to_string(gateway::ListenOptions().port) +
                       ", or the next that is free")
      ->check(CLI::Range(1, 65535));
  command->add_flag("--read-only", args->read_only, "Show the run, and let nobody steer it from there");
  command->callback([args] { ViewRun(*args); });
}

}  // namespace thalweg::cli
