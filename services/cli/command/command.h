#pragma once

#include <CLI/CLI.hpp>
#include <chrono>

namespace thalweg::cli {

/// Longer than any command waits.
inline constexpr std::chrono::hours kForEver{24 * 365};

// Each function adds one subcommand, implemented in a file of its own. The subcommand's callback does the
// work and sets the exit code; main reports its exceptions.
void AddRun(CLI::App& app, int& exit_code);
void AddWatch(CLI::App& app, int& exit_code);
void AddView(CLI::App& app);  ///< Replaces this process by the gateway.
void AddSend(CLI::App& app, int& exit_code);
void AddEvaluate(CLI::App& app, int& exit_code);
void AddStereo(CLI::App& app, int& exit_code);
void AddSurface(CLI::App& app, int& exit_code);
void AddCalibrate(CLI::App& app, int& exit_code);
void AddOdometry(CLI::App& app, int& exit_code);
void AddRecord(CLI::App& app, int& exit_code);
void AddReplay(CLI::App& app, int& exit_code);
void AddBag(CLI::App& app, int& exit_code);
void AddMap(CLI::App& app, int& exit_code);
void AddList(CLI::App& app);  ///< `scenarios` and `strategies`.
void AddTopic(CLI::App& app, int& exit_code);
void AddNode(CLI::App& app, int& exit_code);
void AddDoctor(CLI::App& app, int& exit_code);
void AddDescribe(CLI::App& app);  ///< `completion` and `manual`, for installers; --help does not list them.

}  // namespace thalweg::cli
