#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/base/nearest_name.h"
#include "common/base/text.h"
#include "common/base/version.h"

namespace thalweg {

/// Exit code for an invalid command line. 0 is success, 1 any other failure.
inline constexpr int kExitUsage = 2;

/// Adds --version to `app`, which prints its name and the version of thalweg.
inline void AddVersion(CLI::App& app) {
  app.set_version_flag("--version", app.get_name() + " " + std::string(Version()),
                       "Print the version and exit");
}

/// The values of an enumeration by the names that a command line has for them.
template <class Enum>
using NamedValues = std::vector<std::pair<std::string, Enum>>;

/// The name of a value that has one, so that a help states the default that the options have.
template <class Enum>
std::string NameAmong(const NamedValues<Enum>& values, Enum value) {
  const auto named = std::ranges::find(values, value, &std::pair<std::string, Enum>::second);
  THALWEG_CHECK(named != values.end());
  return named->first;
}

/// Accepts the names of an enumeration's values and nothing else. CLI::CheckedTransformer would print values
/// in the help and in errors.
template <class Enum>
CLI::Validator OneOf(NamedValues<Enum> values) {
  const auto transform = [values = std::move(values)](std::string& text) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) {
      names.push_back(name);
      if (name != text) continue;
      text = std::to_string(static_cast<int>(value));
      return std::string();
    }
    return '"' + text + "\" is not " + Joined(names, " or ");
  };
  return {transform, ""};
}

/// What is wrong with an argument that no command expects.
inline std::string UnexpectedArgumentText(const CLI::App& app, const std::string& argument) {
  if (!argument.starts_with('-')) return "the argument " + argument + " was not expected";
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  std::vector<std::string> names;
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::string option = argument.substr(0, argument.find('='));
  return command->get_name() + " has no option " + option + DidYouMean(names, option);
}

/// Prints the help if it was requested, else the error, as "NAME: ...".
/// @return The exit code.
inline int ReportParseError(CLI::App& app, const CLI::ParseError& error, const std::string& name) {
  // CLI11 reports a missing argument before an unknown one, but the unknown one is more often the mistake.
  const std::vector<std::string> unknown = app.remaining(true);
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const bool extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const std::string what =
      (missing || extra) && !unknown.empty() ? UnexpectedArgumentText(app, unknown[0]) : error.what();
  app.failure_message([&](const CLI::App*, const CLI::Error&) {
    return name + ": " + what + "\nRun with --help for more information.\n";
  });
  return app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage;
}

}  // namespace thalweg
