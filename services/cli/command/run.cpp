#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>

#include "common/base/text.h"
#include "common/scenario/models.h"
#include "common/service/service.h"
#include "services/cli/adapter/defaults.h"
#include "services/cli/command/command.h"
#include "services/cli/command/observation.h"
#include "services/cli/process/supervisor.h"
#include "services/gateway/adapter/options.h"
#include "services/mapper/adapter/mapper_service.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

/// Name of the recording in the folder of the run.
constexpr const char* kRecording = "recording.mcap";
constexpr auto kWriter = "mapper";  // the service whose end leaves files
constexpr auto kSimulator = "simulator";

struct Args {
  RunArgs run;
  bool respawn = false;
  bool keep_going = false;
  bool print_scenario = false;
  bool view = false;
  std::vector<std::string> without;
  std::string record;  ///< File; empty = do not record.
};

OnDeath OnDeathFrom(const Args& args) {
  if (args.respawn) return OnDeath::kRespawn;
  return args.keep_going ? OnDeath::kKeepGoing : OnDeath::kEndRun;
}

/// A service of this run, whose executable is in the folder of our own.
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

/// Records the run. A recording that fails, e.g. on a full disk, does not end the run.
Program RecorderProgram(const Args& args, const std::filesystem::path& folder) {
  Program program = ServiceProgram("recorder", args, folder);
  program.executable = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path file =
      args.record == kRecording ? folder / kRecording : std::filesystem::path(args.record);
  program.arguments = {"record", "--out", file.string(), "--scenario", (folder / "scenario.txtpb").string()};
  if (args.run.domain >= 0) {
    program.arguments.insert(program.arguments.end(), {"--domain", std::to_string(args.run.domain)});
  }
  program.expendable = true;
  return program;
}

/// What is wrong with the height at which a robot that drives starts; empty if nothing is.
std::string FloatingText(const RobotModel& robot, const simulator::World& world,
                         const Eigen::Vector3d& start_W) {
  constexpr double kHighest = 0.25;  // [m] of wheels, and of the voxel that must be free below the body
  constexpr double kDeepest = 100.0;
  if (!robot.drives) return "";
  const Eigen::Vector3d bottom_W = start_W - 0.5 * robot.height * Eigen::Vector3d::UnitZ();
  const auto floor = world.CastRay(bottom_W, -Eigen::Vector3d::UnitZ(), kDeepest);
  if (floor && floor->distance <= kHighest) return "";
  const std::string distance =
      floor ? fmt::format("{:.2f} m above the floor", floor->distance) : "above no floor";
  return "the robot drives, but starts " + distance +
         ", and explores only the heights that its body sweeps: set simulator.start_position_m";
}

/// Checks that the simulator can load its world and that the robot fits at its start, before any process is
/// started. Returns warnings.
std::vector<std::string> CheckPlace(const Scenario& scenario) {
  const simulator::World world = simulator::LoadWorld(scenario);
  simulator::CheckExtent(world, mapper::OptionsFrom(scenario, {}).map.voxel_size);
  Scenario given = scenario;
  given.mutable_simulator()->clear_start_seed();  // a random start is connected to the given one
  const RobotModel robot = RobotFrom(scenario);
  const RigidTransform T_WB = simulator::StartFrom(given, world, robot);
  const std::string floating = FloatingText(robot, world, T_WB.translation());
  return floating.empty() ? std::vector<std::string>() : std::vector<std::string>{floating};
}

/// The last lines of a service's log usually contain the cause.
Failure FailureFrom(const Death& death) {
  constexpr int kLines = 10;
  constexpr std::size_t kMostOfALine = 500;  // a log may quote what came from the network
  const std::string lines = LastLines(death.log, kLines);
  if (lines.empty()) return {death.what, "; " + death.log.string() + " is empty"};
  Failure failure{death.what, "; the last lines of " + death.log.string() + ":"};
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) failure.details += "\n    " + CleanText(line, kMostOfALine);
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

/// The services that the scenario needs. The mapper reads clouds from a single topic, and all services read
/// poses from a single topic; the scenario's sources determine who publishes them.
std::vector<std::string> AllServicesOf(const Scenario& scenario) {
  std::vector<std::string> names{"mapper", "explorer", "controller", "simulator"};
  // Starts before the simulator, so as not to miss its first image.
  if (scenario.odometry_source() == OdometrySource::VISUAL_ODOMETRY) {
    names.insert(names.end() - 1, "visual-odometry");
  }
  if (scenario.depth_source() == DepthSource::STEREO) names.insert(names.begin(), "stereo");
  return names;
}

/// The services that this run starts. Throws std::runtime_error if one that is to be left out is not among
/// them.
std::vector<std::string> ServicesOf(const Scenario& scenario, const std::vector<std::string>& without) {
  std::vector<std::string> names = AllServicesOf(scenario);
  for (const std::string& name : without) {
    if (std::erase(names, name) > 0) continue;
    throw std::runtime_error("--without " + name + ": the scenario has no such service; it has " +
                             Listed(AllServicesOf(scenario)));
  }
  return names;
}

/// Limits a run whose services all run here to this machine, unless a network is named: by the scenario or by
/// the environment.
void KeepToThisMachine(Scenario& scenario, const Args& args) {
  const dds::BusOptions named = BusOptionsFrom(scenario, {}, "thalweg");
  const bool is_named = scenario.network().has_local_only() || !named.network_interface.empty() ||
                        !named.discovery_server.empty() || !named.peers.empty();
  if (!is_named && args.without.empty()) scenario.mutable_network()->set_local_only(true);
}

/// Lets the controller check paths where the map costs it no link, unless the scenario says otherwise.
void CheckPathsWithMapper(Scenario& scenario, const std::vector<std::string>& services) {
  if (scenario.controller().has_check_paths() || std::ranges::count(services, "mapper") == 0) return;
  scenario.mutable_controller()->set_check_paths(true);
}

int Run(const Args& args) {
  const bool without_simulator = std::ranges::count(args.without, kSimulator) > 0;
  Scenario scenario =
      LoadScenario(args.run, without_simulator || args.print_scenario ? Robot::kOwn : Robot::kSimulated);
  KeepToThisMachine(scenario, args);
  const std::vector<std::string> services = ServicesOf(scenario, args.without);
  CheckPathsWithMapper(scenario, services);
  if (args.print_scenario) {
    if (args.run.domain >= 0) scenario.mutable_network()->set_domain(args.run.domain);
    std::cout << CommentedText(WithDefaults(scenario), scenario);
    return EXIT_SUCCESS;
  }
  const std::stop_token stop = StopOnSignals();  // before any other thread exists that could receive a signal
  std::vector<std::string> warnings;
  if (!without_simulator) warnings = CheckPlace(scenario);
  const std::filesystem::path folder = MakeRunFolder(args.run);
  LiveDisplay display(std::cout, args.run.json);
  Supervisor supervisor(OnDeathFrom(args), [&](const std::string& text) { display.PrintLine(text); });
  // The run does not depend on its viewer
  Supervisor viewer(OnDeath::kKeepGoing, [&](const std::string& text) { display.PrintLine(text); });
  RunDriver driver;
  driver.warnings = std::move(warnings);
  driver.introduction = "Starting " + Listed(services) + ".";
  if (!args.without.empty())
    driver.introduction += " Expecting " + Listed(args.without) + " to be started elsewhere.";
  if (scenario.network().local_only()) {
    driver.introduction += " Other machines are ignored (--set network.local_only=false admits them).";
  }
  if (const std::string map = mapper::MapperService::kCheckpointFile; std::filesystem::exists(folder / map)) {
    driver.introduction += " The mapper resumes from " + map + " in that folder if it can (see mapper.log).";
  }
  if (args.view) {
    driver.introduction += " Open " + gateway::UrlOf(gateway::ListenOptionsFromEnvironment()) + " to see it.";
  }
  driver.alone = true;
  driver.begin = [&] {
    SaveScenario(scenario, folder / "scenario.txtpb");
    if (!args.record.empty()) supervisor.Start(RecorderProgram(args, folder));
    for (const std::string& name : services) {
      supervisor.Start(ServiceProgram(name, args, folder));
    }
    if (args.view) viewer.Start(ServiceProgram("gateway", args, folder));
  };
  driver.look_after = [&]() -> std::optional<Failure> {
    viewer.Watch();
    const std::optional<Death> death = supervisor.Watch();
    return death ? std::optional(FailureFrom(*death)) : std::nullopt;
  };
  driver.finish = [&] {
    std::vector<std::string> lost;
    for (const std::string& name : supervisor.Stop(10s)) {
      const std::string what = name + " did not stop and was killed";
      if (name == kWriter) {
        lost.push_back(what);
      } else {
        display.PrintLine(what);
      }
    }
    for (const Death& death : supervisor.failed_to_stop()) {
      const Failure failed = FailureFrom(death);
      lost.push_back(failed.what + failed.details);
    }
    viewer.Stop(2s);
    return lost;
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
  command->add_flag("--record{" + std::string(kRecording) + "}", args->record,
                    "Record all topics; --record=FILE elsewhere than in the folder of the run");
  command->add_flag("--view", args->view, "Show the run in the browser, at the address that is printed");
  command->add_flag("--print-scenario", args->print_scenario,
                    "Print the scenario with all defaults, marked as such, and exit");
  command->callback([args, &exit_code] { exit_code = Run(*args); });
}

}  // namespace thalweg::cli
