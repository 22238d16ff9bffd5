#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "services/cli/command/command.h"

/// thalweg: the command that a person types.
int main(int argc, char** argv) try {
  int exit_code = EXIT_SUCCESS;
  CLI::App app("Open autonomous 3D exploration");
  app.require_subcommand(1);
  thalweg::cli::AddRun(app, exit_code);
  thalweg::cli::AddWatch(app, exit_code);
  thalweg::cli::AddOdometry(app, exit_code);
  CLI11_PARSE(app, argc, argv);
  return exit_code;
} catch (const std::exception& error) {
  std::cerr << "thalweg: " << error.what() << '\n';
  return EXIT_FAILURE;
}
