#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "common/base/text.h"
#include "common/service/service.h"
#include "services/cli/adapter/defaults.h"
#include "services/cli/adapter/observation.h"
#include "services/cli/adapter/place_check.h"
#include "services/cli/adapter/run_plan.h"
#include "services/cli/adapter/service_names.h"
#include "services/cli/command/command.h"
#include "services/cli/command/run_args.h"
#include "services/cli/process/browser.h"
#include "services/cli/process/failure.h"
#include "services/cli/process/run_programs.h"
#include "services/cli/process/supervisor.h"
#include "services/gateway/adapter/options.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

/// Name of the recording in the folder of the run.
constexpr const char* kRecording = "recording.mcap";

struct RunCommandArgs {
  RunArgs run;
  bool respawn = false;
  bool keep_going = false;
  bool print_scenario = false;
  bool view = false;
  bool surface = false;
  std::vector<std::string> without;
  std::string record;  ///< File; empty = do not record.
};

OnDeath OnDeathFrom(const RunCommandArgs& args) {
  if (args.respawn) return OnDeath::kRespawn;
  return args.keep_going ? OnDeath::kKeepGoing : OnDeath::kEndRun;
}

RunPlace PlaceOf(const RunCommandArgs& args, const std::filesystem::path& folder) {
  return {.folder = folder, .domain = args.run.domain >= 0 ? std::optional(args.run.domain) : std::nullopt};
}

int Run(const RunCommandArgs& args) {
  const bool without_simulator = std::ranges::count(args.without, kSimulator) > 0;
  Scenario scenario =
      ScenarioOfRun(args.run, without_simulator || args.print_scenario ? Robot::kOwn : Robot::kSimulated);
  KeepToThisMachine(scenario, args.without.empty());
  const std::vector<std::string> services = ServicesOf(scenario, args.without);
  CheckPathsWithMapper(scenario, services);
  if (args.print_scenario) {
    if (args.run.domain >= 0) scenario.mutable_network()->set_domain(args.run.domain);
    std::cout << CommentedText(WithDefaults(scenario), scenario);
    return EXIT_SUCCESS;
  }
  const std::stop_token stop = StopOnSignals();  // before any other thread exists that could receive a signal
  RunDriver driver;
  if (!without_simulator) driver.warnings = CheckPlace(scenario);
  const RunPlace place = PlaceOf(args, MakeRunFolder(args.run));
  LiveDisplay display(std::cout, args.run.json);
  const auto say = [&](const std::string& text) { display.PrintLine(text); };
  Supervisor supervisor(OnDeathFrom(args), say);
  Supervisor viewer(OnDeath::kRespawnIfKilled, say);
  Supervisor inspector(OnDeath::kRespawnIfKilled, say);  // which goes on from its checkpoint
  driver.introduction = IntroductionText(scenario, args.without, args.surface, place.folder);
  // Asked before anything is started, since a mistake in the environment is an error.
  gateway::ListenOptions listen = gateway::ListenOptionsFromEnvironment();
  std::optional<int> shown_port;
  driver.alone = true;
  driver.begin = [&] {
    SaveScenario(scenario, place.ScenarioFile());
    if (!args.record.empty()) {
      const bool beside = args.record == kRecording;
      const std::filesystem::path file =
          beside ? place.folder / kRecording : std::filesystem::path(args.record);
      supervisor.Start(RecorderProgram(file, place, ScenarioName(args.run.scenario)));
    }
    for (const std::string& name : services) supervisor.Start(ServiceProgram(name, place));
    if (args.surface) inspector.Start(ServiceProgram(kSurface, place));
    if (args.view) viewer.Start(GatewayProgram(place));
  };
  driver.look_after = [&]() -> std::optional<Failure> {
    viewer.Watch();
    inspector.Watch();
    // Not always that of the environment, since another gateway may have it, nor that of before a restart.
    const std::optional<int> port = args.view ? TakeAnnouncedPort(place) : std::nullopt;
    if (port && port != shown_port) {
      shown_port = port;
      listen.port = *port;
      ShowPage(listen, "to see the run.", isatty(STDOUT_FILENO) != 0, say);
    }
    const std::optional<Death> death = supervisor.Watch();
    return death ? std::optional(FailureFrom(*death)) : std::nullopt;
  };
  if (args.surface) driver.finish_heard = [&] { return StopServices(inspector, 60s, kSurface, say); };
  driver.finish = [&] {
    std::vector<std::string> lost = StopServices(supervisor, 10s, kMapper, say);
    viewer.Stop(2s);
    return lost;
  };
  return Observe(scenario, args.run, place.folder, stop, display, driver);
}

}  // namespace

void AddRun(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<RunCommandArgs>();
  CLI::App* command =
      app.add_subcommand("run", "Explore a scenario: start its services, follow them and write a report");
  AddRunArgs(*command, args->run);
  auto* respawn =
      command->add_flag("--respawn", args->respawn, "Restart a service when it dies, at most 5 times each");
  command
      ->add_flag("--keep-going", args->keep_going,
                 "Continue when a service dies, so that it can be restarted by hand")
      ->excludes(respawn);
  command
      ->add_option("--without", args->without,
                   "Do not start this service, so that your own takes its place; may be repeated")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return std::ranges::count(kServices, name) > 0
                       ? ""
                       : "\"" + name + "\" is no service; there are " + Joined(kServices);
          },
          "SERVICE"));
  command->add_flag("--record{" + std::string(kRecording) + "}", args->record,
                    "Record all topics; --record=FILE elsewhere than in the folder of the run");
  command->add_flag("--view", args->view,
                    "Show the run in the browser, at the address that is printed; where there is a display, "
                    "open it");
  command->add_flag("--surface", args->surface,
                    "Fuse the clouds into one surface, too (service surface), and leave its mesh, "
                    "map_surface.ply, beside the map");
  command->add_flag("--print-scenario", args->print_scenario,
                    "Print the scenario with all defaults, marked as such, and exit");
  command->callback([args, &exit_code] { exit_code = WithEvents(args->run, [&] { return Run(*args); }); });
}

}  // namespace thalweg::cli
