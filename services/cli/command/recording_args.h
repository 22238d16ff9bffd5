#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "common/scenario/scenario.h"
#include "services/recorder/adapter/recording_file.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::cli {

/// Options of the commands that handle undecoded samples: where the bus is.
struct NetworkArgs {
  std::string scenario = kDefaultScenario;  ///< Name or file; its block `network` counts.
  int domain = -1;                          ///< -1 = from THALWEG_DOMAIN or the scenario.
};
void AddNetworkArgs(CLI::App& command, NetworkArgs& args);

/// A bus that uses no topic itself, so that all can be used undecoded.
dds::BusOptions BusOptionsFrom(const NetworkArgs& args, const std::string& name);

/// Options of the commands that write a recording.
void AddRecordingArgs(CLI::App& command, recorder::RecordingOptions& options);

/// Prints each problem on stderr; returns the exit code.
int ReportProblems(const recorder::Problems& problems);

}  // namespace thalweg::cli
