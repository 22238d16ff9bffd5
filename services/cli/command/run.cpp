#include <iostream>
#include <memory>

#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/observation.h"
#include "services/cli/process/supervisor.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

struct Args {
  RunArgs run;
  bool respawn = false;
  bool keep_going = false;
};

OnDeath OnDeathFrom(const Args& args) {
  if (args.respawn) return OnDeath::kRespawn;
  return args.keep_going ? OnDeath::kKeepGoing : OnDeath::kEndRun;
}

/// A service of this run; its executable stands beside our own.
Program ServiceProgram(const std::string& name, const Args& args, const std::filesystem::path& folder) {
  const auto own = std::filesystem::read_symlink("/proc/self/exe");
  Program program;
  program.name = name;
  program.executable = own.parent_path() / ("thalweg-" + name);
  program.arguments = {"--scenario", (folder / "scenario.txtpb").string(), "--out", folder.string()};
  if (args.run.domain >= 0) {
    program.arguments.insert(program.arguments.end(), {"--domain", std::to_string(args.run.domain)});
  }
  program.log = folder / (name + ".log");
  return program;
}

int Run(const Args& args) {
  const Scenario scenario = LoadScenario(args.run.scenario, args.run.overrides);
  const std::filesystem::path folder = MakeRunFolder(args.run);
  SaveScenario(scenario, folder / "scenario.txtpb");
  const std::stop_token stop = StopOnSignals();
  LiveDisplay display(std::cout);
  Supervisor supervisor(OnDeathFrom(args), [&](const std::string& text) { display.Tell(text); });
  RunDriver driver;
  driver.begin = [&] {
    std::vector<std::string> names = {"mapper", "controller", "explorer", "simulator"};
    // It makes the odometry that the simulator makes without it; before that one, whose first image counts.
    if (scenario.has_visual_odometry()) names.insert(names.end() - 1, "visual-odometry");
    for (const std::string& name : names) supervisor.Start(ServiceProgram(name, args, folder));
  };
  driver.look_after = [&] { return supervisor.Watch(); };
  driver.finish = [&] {
    for (const std::string& name : supervisor.Stop(10s)) display.Tell(name + " had to be killed");
  };
  return Observe(scenario, args.run, folder, stop, display, driver);
}

}  // namespace

void AddRun(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  CLI::App* command =
      app.add_subcommand("run", "Explore a scenario: starts its processes and writes a report");
  AddRunArgs(*command, args->run);
  auto* respawn = command->add_flag("--respawn", args->respawn,
                                    "Start a process again when it dies, at most 5 times each");
  command->add_flag("--keep-going", args->keep_going, "Go on when a process dies: it is restarted by hand")
      ->excludes(respawn);
  command->callback([args, &exit_code] { exit_code = Run(*args); });
}

}  // namespace thalweg::cli
