#pragma once

#include <CLI/CLI.hpp>

#include "services/recorder/adapter/recording_file.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::cli {

/// Options of the commands that write a recording.
void AddRecordingArgs(CLI::App& command, recorder::RecordingOptions& options);

/// Prints each problem on stderr; returns the exit code.
int ReportProblems(const recorder::Problems& problems);

}  // namespace thalweg::cli
