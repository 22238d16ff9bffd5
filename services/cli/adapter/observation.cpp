#include "services/cli/adapter/observation.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <future>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/base/version.h"
#include "common/dds/bus.h"
#include "common/files/write_file.h"
#include "common/service/service.h"
#include "services/cli/adapter/defaults.h"
#include "services/cli/adapter/observer.h"
#include "services/cli/adapter/report_files.h"
#include "services/cli/process/domain_claim.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/run_summary.h"
#include "services/cli/report/warning_filter.h"
#include "services/controller/adapter/options.h"
#include "services/explorer/adapter/options.h"
#include "services/link/adapter/options.h"
#include "services/simulator/adapter/mistakes.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr auto kLongerThanAnyRun = std::chrono::hours(24 * 365);

/// The live line owns the terminal, so the libraries' log goes to a file.
void LogTo(const std::filesystem::path& file) {
  spdlog::set_default_logger(spdlog::basic_logger_mt("thalweg", file.string()));
  spdlog::flush_on(spdlog::level::info);
  spdlog::set_error_handler([](const std::string&) {});  // a full disk, which Warnings reports
}

/// Shows each warning once, when it first occurs.
class Warnings {
 public:
  Warnings(const std::filesystem::path& folder, LiveDisplay& display) : folder_(folder), display_(display) {}

  void ShowOwn(const std::string& warning) {
    if (filter_.AdmitOwn(warning)) Print(warning);
  }
  void ShowReported(const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) {
      if (filter_.AdmitReported(warning)) Print(warning);
    }
    CheckSpace();
  }

 private:
  static constexpr std::uintmax_t kLittleSpace = 10'000'000;  // [B]

  void Print(const std::string& warning) {
    display_.PrintLine("warning: " + warning, LiveDisplay::Tone::kWarning);
  }
  void CheckSpace() {
    std::error_code unknown;
    const auto space = std::filesystem::space(folder_, unknown);
    if (unknown || space.available >= kLittleSpace) return;
    ShowOwn("less than 10 MB are left on the disk of " + folder_.string() +
            ": maps, logs and the report may be incomplete; the run continues");
  }

  std::filesystem::path folder_;
  LiveDisplay& display_;
  WarningFilter filter_;
};

std::string DateAndTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::array<char, 32> text;
  std::strftime(text.data(), text.size(), "%Y%m%d-%H%M%S", &local);
  return text.data();
}

std::filesystem::path MadeFolder(const std::filesystem::path& folder) {
  CheckFolderWritable(folder);
  return std::filesystem::absolute(folder);
}

/// Makes a folder that no other run has, even if one of the same scenario begins at the same time.
std::filesystem::path NewFolderFor(const std::string& scenario) {
  const std::filesystem::path runs = MadeFolder("runs");
  const std::string name = ScenarioName(scenario) + "-" + DateAndTime();
  std::filesystem::path folder = runs / name;
  for (int n = 2; !std::filesystem::create_directory(folder); ++n)
    folder = runs / (name + "-" + std::to_string(n));
  return folder;
}

}  // namespace

Scenario ScenarioOfRun(const RunArgs& args, Robot robot) {
  const auto mistakes = [&](const Scenario& scenario) {
    std::vector<Mistake> found = explorer::MistakesIn(scenario);
    const auto add = [&found](std::vector<Mistake> more) {
      std::move(more.begin(), more.end(), std::back_inserter(found));
    };
    add(controller::MistakesIn(scenario));
    if (scenario.has_link()) {  // links, which are started beside a run, are meant to carry it
      ServiceArgs service;
      service.domain = args.domain;
      add(link::MistakesIn(scenario, BusOptionsFrom(scenario, service, "thalweg").domain));
    }
    if (robot == Robot::kSimulated) add(simulator::MistakesIn(scenario));
    return found;
  };
  return LoadScenario(args.scenario, args.overrides, {.with_defaults = WithDefaults, .mistakes = mistakes});
}

std::string ScenarioName(const std::string& name_or_file) {
  return std::filesystem::path(name_or_file).stem().string();
}

std::filesystem::path MakeRunFolder(const RunArgs& args) {
  const std::filesystem::path folder = args.out.empty() ? NewFolderFor(args.scenario) : MadeFolder(args.out);
  for (const char* file : {"scenario.txtpb", "report.json"}) {
    if (std::filesystem::exists(folder / file)) {
      throw std::runtime_error(folder.string() + " already holds a run (" + file +
                               "): choose another --out or remove it");
    }
  }
  return folder;
}

int WithEvents(const RunArgs& args, const std::function<int()>& explore) try {
  return explore();
} catch (const std::exception& error) {
  LiveDisplay display(std::cout, args.json);
  display.PrintEvent("message", {{"level", "error"}, {"text", error.what()}});
  display.PrintEvent("end", {{"succeeded", false}, {"exit_code", EXIT_FAILURE}});
  throw;
}

int Observe(const Scenario& scenario, const RunArgs& args, const std::filesystem::path& folder,
            std::stop_token stop, LiveDisplay& display, const RunDriver& driver) {
  ServiceArgs service;
  service.domain = args.domain;
  dds::BusOptions options = BusOptionsFrom(scenario, service, "thalweg");
  options.sole = false;  // several people may watch
  std::optional<DomainClaim> claim;
  try {
    if (driver.alone) claim.emplace(options.domain, options.partition + '/' + options.names.robot);
  } catch (const std::exception&) {
    std::error_code not_empty;  // it held something before
    std::filesystem::remove(folder, not_empty);
    throw;
  }
  LogTo(folder / "thalweg.log");
  dds::Bus bus(options);
  Observer observer(scenario, ScenarioName(args.scenario), bus);
  display.PrintEvent("start", {{"scenario", ScenarioName(args.scenario)},
                               {"domain", options.domain},
                               {"folder", folder.string()},
                               {"version", Version()}});
  display.PrintLine("scenario " + ScenarioName(args.scenario) + ", DDS domain " +
                    std::to_string(options.domain) + ", files in " + folder.string());
  display.PrintLine(driver.introduction + " Ctrl-C stops the run and writes its report.");
  driver.begin();
  display.ShowHeading();
  std::optional<Failure> failure;
  Warnings warnings(folder, display);
  for (const std::string& warning : driver.warnings) warnings.ShowOwn(warning);
  bool said_resumed = false;
  bool ended = false;
  bus.EveryWall(1000ms, [&] {
    if (ended) return;
    warnings.ShowReported(observer.warnings());
    if (!said_resumed && observer.map_was_resumed()) {
      display.PrintLine("the mapper resumed its map from a checkpoint: what that held counts as explored");
      said_resumed = true;
    }
  });
  bus.EveryWall(100ms, [&] {
    if (ended) return;
    display.Show(observer.Live());
    if (!failure) failure = driver.look_after();
    if (const auto mixed = observer.failure(); mixed && !failure)
      failure = Failure{.what = *mixed, .details = ""};
  });
  bus.SpinUntil([&] { return stop.stop_requested() || failure || observer.finished(); }, kLongerThanAnyRun);
  display.Release();
  if (failure) display.PrintLine("failed: " + failure->what + failure->details, LiveDisplay::Tone::kError);

  ended = true;
  std::vector<std::string> lost;
  const auto add = [&lost](const std::vector<std::string>& more) {
    lost.insert(lost.end(), more.begin(), more.end());
  };
  // A robot that does not stand by itself is stopped before anything else.
  const bool stands = observer.finished() && !failure;
  if (driver.finish_heard && stands) {
    // While all others still speak: once they are gone, strangers could take their place.
    auto finishing = std::async(std::launch::async, driver.finish_heard);
    bus.SpinUntil([&] { return finishing.wait_for(0s) == std::future_status::ready; }, kLongerThanAnyRun);
    add(finishing.get());
  }
  add(driver.finish());
  if (driver.finish_heard && !stands) add(driver.finish_heard());
  RunRecord record = observer.Record(failure ? failure->what : "interrupted");
  record.warnings.insert(record.warnings.begin(), driver.warnings.begin(), driver.warnings.end());
  record.scenario_text = CommentedText(WithDefaults(scenario), scenario);
  if (!observer.truth_error().empty())
    display.PrintLine("not compared with ground truth: " + observer.truth_error());
  const bool good = record.succeeded && !failure;
  display.PrintLine(SummaryText(record, !scenario.network().wall_clock()),
                    good ? LiveDisplay::Tone::kGood : LiveDisplay::Tone::kWarning);
  if (!record.stop_details.empty()) display.PrintLine(record.stop_details);
  for (const std::string& warning : record.warnings)
    display.PrintLine("warning: " + warning, LiveDisplay::Tone::kWarning);
  for (const std::string& error : lost) display.PrintLine("not saved: " + error, LiveDisplay::Tone::kError);
  const std::vector<std::string> not_written =
      WriteReport(record, observer.map(), observer.tally(), folder, RunPageTemplate());
  for (const std::string& error : not_written)
    display.PrintLine("not saved: " + error, LiveDisplay::Tone::kError);
  display.PrintLine(FilesText(folder));
  const bool all_saved = lost.empty() && not_written.empty();
  const int exit_code = !good ? EXIT_FAILURE : all_saved ? EXIT_SUCCESS : kExitFilesMissing;
  nlohmann::ordered_json report = ToJson(record);
  report.erase("coverage_over");
  display.PrintEvent("end", {{"succeeded", good}, {"exit_code", exit_code}, {"report", std::move(report)}});
  return exit_code;
}

}  // namespace thalweg::cli
