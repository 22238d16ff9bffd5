#pragma once

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <string>

namespace thalweg {

/// Exit code of a command line that is not understood. 0 is success, 1 everything else that went wrong.
inline constexpr int kExitUsage = 2;

/// Prints help where that was asked for, and otherwise what is wrong, as "NAME: ...".
/// @return  The exit code for it.
inline int TellOf(CLI::App& app, const CLI::ParseError& error, const std::string& name) {
  app.failure_message([&name](const CLI::App*, const CLI::Error& what) {
    return name + ": " + what.what() + "\nRun with --help for more information.\n";
  });
  return app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage;
}

}  // namespace thalweg
