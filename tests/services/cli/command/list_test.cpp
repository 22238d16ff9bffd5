// `thalweg strategies`, `thalweg scenarios` and the lists in the help as typed by a user.
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/strategy/registry.h"
#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

TEST(ListCommand, AmongTheStrategiesThatOfARunIsMarkedAsTheDefault) {
  const test::Outcome outcome = test::OutcomeOf(test::BinFolder() + "/thalweg strategies");
  EXPECT_EQ(outcome.exit_code, 0);
  std::vector<std::string> named;
  std::vector<std::string> marked;
  std::istringstream lines(outcome.text);
  for (std::string line; std::getline(lines, line);) {
    named.push_back(line.substr(0, line.find(' ')));
    if (line.ends_with(" (default)")) marked.push_back(named.back());
  }
  EXPECT_THAT(marked, testing::ElementsAre(explorer::ExplorerOptions().strategy.name));
  for (const explorer::StrategyInfo& strategy : explorer::Strategies()) {
    EXPECT_THAT(named, testing::Contains(strategy.name));
  }
}

TEST(ListCommand, EveryShippedScenarioHasALineThatSaysWhatItIs) {
  const test::Outcome outcome = test::OutcomeOf(test::BinFolder() + "/thalweg scenarios");
  EXPECT_EQ(outcome.exit_code, 0);
  std::map<std::string, std::string> summaries;
  std::istringstream lines(outcome.text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find(' ');
    ASSERT_NE(end, std::string::npos) << line;
    summaries[line.substr(0, end)] = line.substr(line.find_first_not_of(' ', end));
  }
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(test::SourceFolder() + "/deploy/scenarios")) {
    if (file.path().extension() != ".txtpb") continue;
    ++files;
    EXPECT_GT(summaries[file.path().stem()].size(), 20U) << file;
  }
  EXPECT_EQ(summaries.size(), files);
  EXPECT_THAT(summaries["kitchen"], HasSubstr("itchen"));
}

TEST(ListCommand, TheHelpOfEvaluateListsTheStrategiesAndMarksNoneSinceItsDefaultsAreOthers) {
  const test::Outcome outcome = test::OutcomeOf(test::BinFolder() + "/thalweg evaluate --help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const explorer::StrategyInfo& strategy : explorer::Strategies()) {
    EXPECT_THAT(outcome.text, HasSubstr("\n  " + std::string(strategy.name) + " "));
  }
  EXPECT_THAT(outcome.text, testing::Not(HasSubstr("(default)")));
}

}  // namespace
}  // namespace thalweg::cli
