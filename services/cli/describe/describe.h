#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace thalweg::cli {

/// Descriptions of a command line for other tools, generated from CLI11's tree: the program, its commands and
/// their options.

/// @return A script for bash that completes commands, options and, for a positional argument "scenario", the
///   names in THALWEG_SCENARIOS or in share/thalweg/scenarios beside the program's bin.
std::string BashCompletion(const CLI::App& app);

/// @return A manual page, section 1, as defined by man(7). It has no date, so that the same program always
///   gives the same page.
std::string ManualPage(const CLI::App& app, const std::string& version);

}  // namespace thalweg::cli
