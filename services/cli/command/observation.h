#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/cli/command/live_display.h"

namespace thalweg::cli {

/// What `run` and `watch` have in common: which run, where to, on which domain.
struct RunArgs {
  std::string scenario = "kitchen";  ///< Name or file.
  std::vector<std::string> overrides;
  std::string out;  ///< Empty: runs/SCENARIO-DATE-TIME.
  int domain = -1;  ///< -1 = THALWEG_DOMAIN, or the scenario's.
};
void AddRunArgs(CLI::App& command, RunArgs& args);

/// The scenario with what is said over it. Throws naming every mistake in it, and those beside the services'
/// defaults.
Scenario LoadScenario(const RunArgs& args);

/// Its name for people and folders: "kitchen" for deploy/scenarios/kitchen.txtpb.
std::string ScenarioName(const std::string& name_or_file);

/// Makes the folder for a run's files. Throws std::runtime_error when another run's are in it already.
std::filesystem::path MakeRunFolder(const RunArgs& args);

/// Why a run had to end.
struct Failure {
  std::string what;     ///< In the report, too.
  std::string details;  ///< For the screen alone; may be several lines.
};

/// The part that is not the same for all runs.
struct RunDriver {
  std::string introduction;             ///< One line for people, before it begins.
  bool alone = false;                   ///< Must not begin where another run is going on.
  std::function<void()> begin = [] {};  ///< Once all of it can be heard.
  /// Called ten times a second: what went wrong, when the run must end for it.
  std::function<std::optional<Failure>()> look_after = [] { return std::nullopt; };
  std::function<void()> finish = [] {};  ///< Before the report is written.
};

/// Follows a run until it is complete, `stop` is asked for or something went wrong, and writes the report.
/// @return  The exit code: 0 only when the exploration is complete.
int Observe(const Scenario& scenario, const RunArgs& args, const std::filesystem::path& folder,
            std::stop_token stop, LiveDisplay& display, const RunDriver& driver);

}  // namespace thalweg::cli
