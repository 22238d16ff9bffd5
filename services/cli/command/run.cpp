#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>

#include "common/scenario/models.h"
#include "common/service/service.h"
#include "services/cli/adapter/defaults.h"
#include "services/cli/command/command.h"
#include "services/cli/command/observation.h"
#include "services/cli/process/supervisor.h"
#include "services/mapper/adapter/mapper_service.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

struct Args {
  RunArgs run;
  bool respawn = false;
  bool keep_going = false;
  bool print_scenario = false;
  std::vector<std::string> without;
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

/// Whether the simulator will have a world, and the robot a place in it: told before any process is started.
void CheckPlace(const Scenario& scenario) {
  const simulator::World world = simulator::LoadWorld(scenario);
  simulator::CheckExtent(world, mapper::OptionsFrom(scenario, {}).map.voxel_size);
  Scenario given = scenario;
  given.mutable_simulator()->clear_start_seed();  // a random start is connected to the given one
  simulator::StartFrom(given, world, RobotFrom(scenario));
}

/// What its log says last is most often why.
Failure FailureFrom(const Death& death) {
  constexpr int kLines = 10;
  const std::string lines = LastLines(death.log, kLines);
  if (lines.empty()) return {death.what, "; " + death.log.string() + " is empty"};
  Failure failure{death.what, "; the last lines of " + death.log.string() + ":"};
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) failure.details += "\n    " + line;
  return failure;
}

/// "a, b and c"
std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n) {
    text += (n == 0 ? "" : n + 1 == names.size() ? " and " : ", ") + names[n];
  }
  return text;
}

/// The mapper takes its clouds from one topic, and all take their pose from one: the sources say who fills
/// them.
std::vector<std::string> AllServicesOf(const Scenario& scenario) {
  std::vector<std::string> names{"mapper", "explorer", "controller", "simulator"};
  // Before the simulator, whose first image counts.
  if (scenario.odometry_source() == OdometrySource::VISUAL_ODOMETRY) {
    names.insert(names.end() - 1, "visual-odometry");
  }
  if (scenario.depth_source() == DepthSource::STEREO) names.insert(names.begin(), "stereo");
  return names;
}

/// Those that this run starts. Throws std::runtime_error when one that is left out is none of them.
std::vector<std::string> ServicesOf(const Scenario& scenario, const std::vector<std::string>& without) {
  std::vector<std::string> names = AllServicesOf(scenario);
  for (const std::string& name : without) {
    if (std::erase(names, name) > 0) continue;
    throw std::runtime_error("--without " + name + ": the scenario has no such service; it has " +
                             Listed(AllServicesOf(scenario)));
  }
  return names;
}

int Run(const Args& args) {
  Scenario scenario = LoadScenario(args.run);
  if (args.print_scenario) {
    if (args.run.domain >= 0) scenario.mutable_network()->set_domain(args.run.domain);
    std::cout << CommentedText(WithDefaults(scenario), scenario);
    return EXIT_SUCCESS;
  }
  const std::vector<std::string> services = ServicesOf(scenario, args.without);
  const std::stop_token stop = StopOnSignals();  // before there are threads, of which one might take a signal
  if (std::find(services.begin(), services.end(), "simulator") != services.end()) CheckPlace(scenario);
  const std::filesystem::path folder = MakeRunFolder(args.run);
  LiveDisplay display(std::cout);
  Supervisor supervisor(OnDeathFrom(args), [&](const std::string& text) { display.Tell(text); });
  RunDriver driver;
  driver.introduction = "Starting " + Listed(services) + ".";
  if (!args.without.empty())
    driver.introduction += " Expecting " + Listed(args.without) + " to be started elsewhere.";
  if (const std::string map = mapper::MapperService::kCheckpointFile; std::filesystem::exists(folder / map)) {
    driver.introduction += " The mapper resumes from " + map + " in that folder if it can (see mapper.log).";
  }
  driver.alone = true;
  driver.begin = [&] {
    SaveScenario(scenario, folder / "scenario.txtpb");
    for (const std::string& name : services) {
      supervisor.Start(ServiceProgram(name, args, folder));
    }
  };
  driver.look_after = [&]() -> std::optional<Failure> {
    const std::optional<Death> death = supervisor.Watch();
    return death ? std::optional(FailureFrom(*death)) : std::nullopt;
  };
  driver.finish = [&] {
    for (const std::string& name : supervisor.Stop(10s)) display.Tell(name + " did not stop and was killed");
  };
  return Observe(scenario, args.run, folder, stop, display, driver);
}

}  // namespace

void AddRun(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  CLI::App* command =
      app.add_subcommand("run", "Explore a scenario: start its services, follow them and write a report");
  AddRunArgs(*command, args->run);
  auto* respawn =
      command->add_flag("--respawn", args->respawn, "Restart a service when it dies, at most 5 times each");
  command
      ->add_flag("--keep-going", args->keep_going,
                 "Continue when a service dies, so that it can be restarted by hand")
      ->excludes(respawn);
  command->add_option("--without", args->without,
                      "Do not start this service, so that your own takes its place; may be repeated");
  command->add_flag("--print-scenario", args->print_scenario,
                    "Print the scenario with all defaults, marked as such, and exit");
  command->callback([args, &exit_code] { exit_code = Run(*args); });
}

}  // namespace thalweg::cli
