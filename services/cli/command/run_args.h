#pragma once

#include <CLI/CLI.hpp>

#include "services/cli/adapter/observation.h"

namespace thalweg::cli {

/// Adds the options that `run` and `watch` have in common.
void AddRunArgs(CLI::App& command, RunArgs& args);

}  // namespace thalweg::cli
