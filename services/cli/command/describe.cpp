#include "services/cli/describe/describe.h"

#include <iostream>

#include "common/base/version.h"
#include "services/cli/command/command.h"

namespace thalweg::cli {

void AddDescribe(CLI::App& app) {
  app.add_subcommand("completion", "Prints a script that completes this command line in bash")
      ->group("")
      ->callback([&app] { std::cout << BashCompletion(app); });
  app.add_subcommand("manual", "Prints this command line as a manual page")->group("")->callback([&app] {
    std::cout << ManualPage(app, std::string(Version()));
  });
}

}  // namespace thalweg::cli
