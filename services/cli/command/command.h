#pragma once

#include <CLI/CLI.hpp>

namespace thalweg::cli {

// Each adds one subcommand, in a file of its own. Its callback does the work and leaves the exit code; what
// it throws is told by main.
void AddRun(CLI::App& app, int& exit_code);
void AddWatch(CLI::App& app, int& exit_code);
void AddEvaluate(CLI::App& app, int& exit_code);
void AddStereo(CLI::App& app, int& exit_code);
void AddCalibrate(CLI::App& app, int& exit_code);
void AddOdometry(CLI::App& app, int& exit_code);

}  // namespace thalweg::cli
