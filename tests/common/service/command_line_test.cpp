#include "common/service/command_line.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

enum class Drink { kTea, kCoffee };
const NamedValues<Drink> kDrinks = {{"tea", Drink::kTea}, {"coffee", Drink::kCoffee}};

TEST(OneOf, TakesEachNameThatAValueHasAndNoOther) {
  Drink drink = Drink::kTea;
  CLI::App app;
  app.add_option("--drink", drink)->transform(OneOf(kDrinks));
  for (const Drink chosen : {Drink::kCoffee, Drink::kTea}) {
    app.parse("--drink " + NameAmong(kDrinks, chosen));
    EXPECT_EQ(drink, chosen);
  }
  EXPECT_THROW(app.parse("--drink milk"), CLI::ValidationError);
}

/// What is printed about a command line, and its exit code.
std::pair<std::string, int> Report(CLI::App& app, const std::string& arguments) {
  testing::internal::CaptureStderr();
  int exit_code = EXIT_SUCCESS;
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    exit_code = ReportParseError(app, error, "thalweg");
  }
  return {testing::internal::GetCapturedStderr(), exit_code};
}

TEST(ReportParseError, NamesTheOptionThatIsMissingAndTheOneThatWasMeant) {
  const auto report = [](const std::string& arguments) {
    CLI::App app("", "thalweg");
    CLI::App* const run = app.add_subcommand("run");
    run->add_flag("--view");
    run->add_option("--record", "");
    run->add_option("scenario")->required();
    return Report(app, arguments);
  };
  EXPECT_EQ(report("run kitchen --view"), std::pair(std::string(), EXIT_SUCCESS));
  const std::string help = "\nRun with --help for more information.\n";
  EXPECT_EQ(report("run kitchen --vieww --out x").first,
            "thalweg: run has no option --vieww; did you mean --view?" + help);
  EXPECT_EQ(report("run --recrd=x").first,
            "thalweg: run has no option --recrd; did you mean --record?" + help);
  EXPECT_EQ(report("run kitchen --nothing-like-it").first,
            "thalweg: run has no option --nothing-like-it" + help);
  EXPECT_EQ(report("run kitchen flat").first, "thalweg: the argument flat was not expected" + help);
  EXPECT_EQ(report("run kitchen flat").second, kExitUsage);
}

}  // namespace
}  // namespace thalweg
