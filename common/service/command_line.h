#pragma once

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/base/version.h"

namespace thalweg {

/// Exit code of a command line that is not understood. 0 is success, 1 everything else that went wrong.
inline constexpr int kExitUsage = 2;

/// Lets `app` answer --version: its name and the version of thalweg.
inline void AddVersion(CLI::App& app) {
  app.set_version_flag("--version", app.get_name() + " " + std::string(Version()),
                       "Print the version and exit");
}

/// Prints help where that was asked for, and otherwise what is wrong, as "NAME: ...".
/// @return  The exit code for it.
inline int TellOf(CLI::App& app, const CLI::ParseError& error, const std::string& name) {
  // CLI11 complains of what is missing before what it does not know, which is more often the mistake.
  const std::vector<std::string> unknown = app.remaining();
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const std::string what =
      missing && !unknown.empty() ? "The following argument was not expected: " + unknown[0] : error.what();
  app.failure_message([&](const CLI::App*, const CLI::Error&) {
    return name + ": " + what + "\nRun with --help for more information.\n";
  });
  return app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage;
}

}  // namespace thalweg
