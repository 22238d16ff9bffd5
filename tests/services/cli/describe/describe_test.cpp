#include "services/cli/describe/describe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/outcome.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A program "sail" with two commands, one of which takes a scenario.
class Describe : public testing::Test {
 protected:
  Describe() {
    CLI::App* const go = app_.add_subcommand("go", "Goes. Uses a \\ and -dashes");
    go->add_option("scenario", scenario_, "Where to go");
    go->add_option("--out,-o", out_, "Folder of the files");
    go->add_flag("--respawn", respawn_, "Starts again");
    app_.add_subcommand("stay", ".dots begin this line");
    CLI::App* const fleet = app_.add_subcommand("fleet", "Several ships");
    fleet->add_subcommand("list", "Lists them");
    fleet->add_subcommand("sink", "Sinks one")->add_option("ship,--ship", ship_, "Which");
    app_.add_subcommand("completion", "For installers")->group("");
  }

  /// What bash completes after these words, the last of which may be empty.
  std::string Completed(const std::string& words) {
    const std::string file = testing::TempDir() + "completion." + std::to_string(getpid());
    std::ofstream(file) << BashCompletion(app_);
    const std::string scenarios = testing::TempDir() + "scenarios." + std::to_string(getpid());
    std::filesystem::create_directory(scenarios);
    std::ofstream(scenarios + "/harbor.txtpb");
    const auto outcome = test::OutcomeOf(
        "THALWEG_SCENARIOS=" + scenarios + " bash -euc '. " + file + "; COMP_WORDS=(" + words +
        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _sail sail; echo \"${COMPREPLY[@]}\"'");
    std::filesystem::remove(file);
    std::filesystem::remove_all(scenarios);
    EXPECT_EQ(outcome.exit_code, 0);
    return outcome.text;
  }

  CLI::App app_{"Sails", "sail"};
  std::string scenario_, out_, ship_;
  bool respawn_ = false;
};

TEST_F(Describe, BashCompletesCommandsOptionsAndScenarios) {
  EXPECT_EQ(Completed("sail \"\""), "go stay fleet\n");
  EXPECT_EQ(Completed("sail s"), "stay\n");
  EXPECT_EQ(Completed("sail go --"), "--help --out --respawn\n");
  EXPECT_EQ(Completed("sail stay --"), "--help\n");
  EXPECT_EQ(Completed("sail go --respawn \"\""), "harbor\n");
}

TEST_F(Describe, CommandsBelowACommandAreCompletedAndInTheManual) {
  EXPECT_EQ(Completed("sail fleet \"\""), "list sink\n");
  EXPECT_EQ(Completed("sail fleet s"), "sink\n");
  EXPECT_EQ(Completed("sail fleet sink --"), "--help --ship\n");
  const std::string page = ManualPage(app_, "1.2.3");
  EXPECT_THAT(page, HasSubstr(".B sail fleet list\n"));
  EXPECT_THAT(page, Not(HasSubstr(".B sail fleet\n")));
  EXPECT_THAT(page, HasSubstr(".SS sail fleet sink\nSinks one\n"));
}

TEST_F(Describe, BashLeavesAnOptionsValueToItsFiles) {
  EXPECT_EQ(Completed("sail go --out \"\""), "\n");
}

TEST_F(Describe, TheManualNamesEveryCommandAndOption) {
  const std::string page = ManualPage(app_, "1.2.3");
  EXPECT_THAT(page, HasSubstr(".TH SAIL 1 \"\" \"sail 1.2.3\""));
  EXPECT_THAT(page, HasSubstr(".SS sail go\nGoes. Uses a \\e and \\-dashes\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-out\\fR \\fITEXT\\fR\nFolder of the files\n"));
  EXPECT_THAT(page, HasSubstr(".SS sail stay\n\\&.dots begin this line\n"));
  EXPECT_THAT(page, Not(HasSubstr("completion")));
}

}  // namespace
}  // namespace thalweg::cli
