#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/cli/process/failure.h"
#include "services/cli/report/live_display.h"

namespace thalweg::cli {

/// What a person chooses for `run` and `watch` alike: scenario, folder and domain.
struct RunArgs {
  std::string scenario = kDefaultScenario;  ///< Name or file.
  std::vector<std::string> overrides;
  std::string out;    ///< Empty = runs/SCENARIO-DATE-TIME.
  int domain = -1;    ///< -1 = from THALWEG_DOMAIN or the scenario.
  bool json = false;  ///< Print JSON, one object a line.
};

enum class Robot {
  kOwn,        ///< A robot, or something in its place, that is started elsewhere.
  kSimulated,  ///< The simulator takes part.
};
/// Loads the scenario with its overrides. Throws an error naming every mistake, including fields that
/// contradict the services' defaults or, if it takes part, the simulator.
Scenario ScenarioOfRun(const RunArgs& args, Robot robot);

/// The scenario's name for people and folders: "kitchen" for deploy/scenarios/kitchen.txtpb.
std::string ScenarioName(const std::string& name_or_file);

/// Makes the folder for a run's files. Throws std::runtime_error if it already contains a run.
std::filesystem::path MakeRunFolder(const RunArgs& args);

/// The part in which `run` and `watch` differ.
struct RunDriver {
  std::string introduction;                ///< One line for people, shown before the run begins.
  std::vector<std::string> warnings = {};  ///< What is known to be wrong before it begins, one line each.
  bool alone = false;                      ///< Whether it must not begin while another run is active.
  std::function<void()> begin = [] {};     ///< Called once everything that it starts can be observed.
  /// Called ten times a second; returns a failure if the run must end.
  std::function<std::optional<Failure>()> look_after = [] { return std::nullopt; };
  /// If set, called at the end: ends what publishes its last figures as it ends. After an exploration that is
  /// done, on another thread, before `finish` and while the run is still listened to; else after `finish`.
  /// Returns what went wrong with its files.
  std::function<std::vector<std::string>()> finish_heard = {};
  /// Called before the report is written; returns what went wrong with the services' own files.
  std::function<std::vector<std::string>()> finish = [] { return std::vector<std::string>(); };
};

/// Exit code of a run that succeeded, but whose files are not all there, or whose mapper failed at the end.
inline constexpr int kExitFilesMissing = 3;

/// Calls `explore` and returns its exit code. If it throws, since the run cannot begin, programs that read
/// the events are given the reason and the end before the exception goes on.
int WithEvents(const RunArgs& args, const std::function<int()>& explore);

/// Observes a run until it is complete, a stop is requested or something fails, and writes the report.
/// A disk that fills up in the meantime does not end it: what could not be written is shown, then and at the
/// end, after the result.
/// @return The exit code: 0 only if the exploration is complete; kExitFilesMissing if it is, but not all of
///   its files were written.
int Observe(const Scenario& scenario, const RunArgs& args, const std::filesystem::path& folder,
            std::stop_token stop, LiveDisplay& display, const RunDriver& driver);

}  // namespace thalweg::cli
