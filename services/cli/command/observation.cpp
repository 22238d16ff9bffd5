#include "services/cli/command/observation.h"

#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <stdexcept>

#include "common/dds/bus.h"
#include "common/service/service.h"
#include "services/cli/adapter/defaults.h"
#include "services/cli/adapter/observer.h"
#include "services/cli/adapter/report_files.h"
#include "services/cli/process/domain_claim.h"
#include "services/explorer/adapter/options.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""h;
using std::chrono_literals::operator""ms;

constexpr auto kForEver = 24h * 365;

/// The live line has the terminal; what the libraries have to say goes to a file.
void LogTo(const std::filesystem::path& file) {
  spdlog::set_default_logger(spdlog::basic_logger_mt("thalweg", file.string()));
  spdlog::flush_on(spdlog::level::info);
}

std::string DateAndTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::array<char, 32> text;
  std::strftime(text.data(), text.size(), "%Y%m%d-%H%M%S", &local);
  return text.data();
}

/// @param simulated  Whether the run's clock is a simulator's and not the wall's.
std::string Summary(const RunRecord& record, bool simulated) {
  std::string summary =
      fmt::format("{}: {:.1f} m in {}{}, {} wall clock; {:.1f} m3 explored", record.stop_reason,
                  record.distance, ClockText(record.duration), simulated ? " simulated" : "",
                  ClockText(record.wall), record.free_volume + record.occupied_volume);
  if (record.coverage && record.agreement) {
    summary += fmt::format("; coverage {:.1f} %, agreement {:.1f} %", 100.0 * *record.coverage,
                           100.0 * *record.agreement);
  }
  if (record.true_collisions) summary += fmt::format("; {} collisions", *record.true_collisions);
  return summary;
}

std::string WhatIsIn(const std::filesystem::path& folder) {
  std::string names;
  for (const char* name : {"report.png", "report.json", "map.bt", "map.ot", "map.ply", "trajectory.tum"}) {
    if (std::filesystem::exists(folder / name)) names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return "files in " + folder.string() + ": " + names + " and logs";
}

}  // namespace

void AddRunArgs(CLI::App& command, RunArgs& args) {
  command.add_option("scenario", args.scenario, "Scenario: a name under deploy/scenarios or a file")
      ->envname("THALWEG_SCENARIO")
      ->capture_default_str();
  command.add_option("--out", args.out, "Folder for the files of the run; default: runs/SCENARIO-DATE-TIME");
  command
      .add_option("--set", args.overrides,
                  "Override a field of the scenario, e.g. mapper.voxel_size_m=0.05; may be repeated")
      ->allow_extra_args(false);
  command
      .add_option(
          "--domain", args.domain,
          "DDS domain; overrides THALWEG_DOMAIN and the scenario. Simultaneous runs need different ones")
      ->check(CLI::Range(0, 232));
}

Scenario LoadScenario(const RunArgs& args) {
  return thalweg::LoadScenario(args.scenario, args.overrides,
                               {.with_defaults = WithDefaults, .mistakes = explorer::MistakesIn});
}

std::string ScenarioName(const std::string& name_or_file) {
  return std::filesystem::path(name_or_file).stem().string();
}

std::filesystem::path MakeRunFolder(const RunArgs& args) {
  std::filesystem::path folder = args.out;
  if (folder.empty())
    folder = std::filesystem::path("runs") / (ScenarioName(args.scenario) + "-" + DateAndTime());
  std::filesystem::create_directories(folder);
  folder = std::filesystem::absolute(folder);
  for (const char* file : {"scenario.txtpb", "report.json"}) {
    if (std::filesystem::exists(folder / file)) {
      throw std::runtime_error(folder.string() + " already holds a run (" + file +
                               "): choose another --out or remove it");
    }
  }
  return folder;
}

int Observe(const Scenario& scenario, const RunArgs& args, const std::filesystem::path& folder,
            std::stop_token stop, LiveDisplay& display, const RunDriver& driver) {
  LogTo(folder / "thalweg.log");
  ServiceArgs service;
  service.domain = args.domain;
  const dds::BusOptions options = BusOptionsFrom(scenario, service, "thalweg");
  std::optional<DomainClaim> claim;
  if (driver.alone) claim.emplace(options.domain, options.partition);
  dds::Bus bus(options);
  Observer observer(scenario, ScenarioName(args.scenario), bus);
  display.Tell("scenario " + ScenarioName(args.scenario) + ", DDS domain " + std::to_string(options.domain) +
               ", files in " + folder.string());
  display.Tell(driver.introduction + " Ctrl-C stops the run and writes its report.");
  driver.begin();
  display.Tell(LiveHeading());
  std::optional<Failure> failure;
  bus.EveryWall(100ms, [&] {
    display.Show(observer.Live());
    if (!failure) failure = driver.look_after();
    if (const auto mixed = observer.failure(); mixed && !failure)
      failure = Failure{.what = *mixed, .details = ""};
  });
  bus.SpinUntil([&] { return stop.stop_requested() || failure || observer.finished(); }, kForEver);
  display.Release();
  if (failure) display.Tell("failed: " + failure->what + failure->details);

  driver.finish();
  const RunRecord record = observer.Record(failure ? failure->what : "interrupted");
  WriteReport(record, observer.map(), folder);
  if (!observer.truth_error().empty())
    display.Tell("not compared with ground truth: " + observer.truth_error());
  display.Tell(Summary(record, !scenario.network().wall_clock()));
  if (!record.end.empty() && record.end != "done: " + record.stop_reason) display.Tell(record.end);
  display.Tell(WhatIsIn(folder));
  return record.succeeded && !failure ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace thalweg::cli
