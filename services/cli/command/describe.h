#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace thalweg::cli {

/// A command line's description for other tools, out of CLI11's tree: the program, its commands, and the
/// options of each.

/// @return  A script for bash that completes commands, options, and, for a positional argument "scenario",
/// the
///          names in THALWEG_SCENARIOS or in share/thalweg/scenarios beside the program's bin.
std::string BashCompletion(const CLI::App& app);

/// @return  A manual page, section 1, as man(7) defines it. It carries no date: the same program gives the
///          same page.
std::string ManualPage(const CLI::App& app, const std::string& version);

/// Adds the commands `completion`, which prints the one, and `manual`, which prints the other, for
/// installers; they are not among those that --help lists.
void AddDescribe(CLI::App& app);

}  // namespace thalweg::cli
