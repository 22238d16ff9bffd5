#include <iostream>
#include <memory>

#include "common/service/service.h"
#include "services/cli/adapter/observation.h"
#include "services/cli/adapter/run_plan.h"
#include "services/cli/command/command.h"
#include "services/cli/command/run_args.h"

namespace thalweg::cli {
namespace {

int Watch(const RunArgs& args) {
  const Scenario scenario = ScenarioOfRun(args, Robot::kOwn);
  const std::filesystem::path folder = MakeRunFolder(args);
  const std::stop_token stop = StopOnSignals();
  LiveDisplay display(std::cout, args.json);
  RunDriver driver;
  driver.introduction = "Waiting for " + NeedsText(scenario) + ", which are started elsewhere.";
  return Observe(scenario, args, folder, stop, display, driver);
}

}  // namespace

void AddWatch(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<RunArgs>();
  CLI::App* command =
      app.add_subcommand("watch", "Follow a run whose services are started elsewhere, and write its report");
  AddRunArgs(*command, *args);
  command->callback([args, &exit_code] { exit_code = WithEvents(*args, [&] { return Watch(*args); }); });
}

}  // namespace thalweg::cli
