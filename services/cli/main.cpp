#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "common/base/nearest_name.h"
#include "common/service/command_line.h"
#include "services/cli/command/command.h"

namespace {

/// CLI11 would only report that a command is missing, neither that the given one does not exist nor which
/// there are.
void RefuseUnknownCommand(const CLI::App& app) {
  const CLI::App* group = &app;  // or that of thalweg topic ..., thalweg send replay ...
  while (!group->get_subcommands().empty()) group = group->get_subcommands().front();
  std::vector<std::string> names;
  for (const CLI::App* command : group->get_subcommands({})) {
    if (!command->get_group().empty()) names.push_back(command->get_name());
  }
  if (names.empty()) return;
  const std::vector<std::string> rest = app.remaining(true);
  if (!rest.empty() && rest[0].starts_with('-')) return;  // an unknown option
  const std::string what =
      rest.empty() ? "a command is missing"
                   : fmt::format("unknown command \"{}\"{}", rest[0], thalweg::DidYouMean(names, rest[0]));
  throw CLI::ParseError(fmt::format("{}; the commands are {}", what, fmt::join(names, ", ")),
                        CLI::ExitCodes::ExtrasError);
}

}  // namespace

/// thalweg: the command line of the project.
int main(int argc, char** argv) try {
  int exit_code = EXIT_SUCCESS;
  CLI::App app("Open autonomous 3D exploration", "thalweg");
  thalweg::AddVersion(app);
  app.require_subcommand(1);
  thalweg::cli::AddRun(app, exit_code);
  thalweg::cli::AddWatch(app, exit_code);
  thalweg::cli::AddView(app);
  thalweg::cli::AddSend(app, exit_code);
  thalweg::cli::AddOdometry(app, exit_code);
  thalweg::cli::AddStereo(app, exit_code);
  thalweg::cli::AddSurface(app, exit_code);
  thalweg::cli::AddCalibrate(app, exit_code);
  thalweg::cli::AddEvaluate(app, exit_code);
  thalweg::cli::AddList(app);
  thalweg::cli::AddRecord(app, exit_code);
  thalweg::cli::AddReplay(app, exit_code);
  thalweg::cli::AddBag(app, exit_code);
  thalweg::cli::AddMap(app, exit_code);
  thalweg::cli::AddTopic(app, exit_code);
  thalweg::cli::AddNode(app, exit_code);
  thalweg::cli::AddDoctor(app, exit_code);
  thalweg::cli::AddDescribe(app);
  try {
    try {
      app.parse(argc, argv);
    } catch (const CLI::RequiredError&) {
      RefuseUnknownCommand(app);
      throw;
    }
  } catch (const CLI::ParseError& error) {
    return thalweg::ReportParseError(app, error, "thalweg");
  }
  return exit_code;
} catch (const std::exception& error) {
  std::cerr << "thalweg: " << error.what() << '\n';
  return EXIT_FAILURE;
}
