#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::test {
namespace {

using testing::HasSubstr;

const std::string kDeploy = SourceFolder() + "/deploy/";
const std::string kTests = SourceFolder() + "/tests/";
const std::string kDocs = SourceFolder() + "/docs/";
const std::string kBin = BinFolder() + "/";

/// Everything that looks like --an-option.
std::set<std::string> OptionsIn(const std::string& text) {
  static const std::regex kOption("--[a-z][a-z-]*");
  std::set<std::string> options;
  for (std::sregex_iterator match(text.begin(), text.end(), kOption), end; match != end; ++match) {
    options.insert(match->str());
  }
  return options;
}

class Command : public testing::TestWithParam<std::string> {};

TEST_P(Command, TellsWhatItDoesWhenAskedForHelp) {
  for (const char* const option : {" --help", " -h"}) {
    const Outcome outcome = OutcomeOf(GetParam() + option);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_TRUE(std::regex_search(outcome.text, std::regex("[Uu]sage: "))) << outcome.text;
    EXPECT_GT(outcome.text.size(), 100U);
  }
}

TEST_P(Command, RefusesAnOptionThatItDoesNotKnow) {
  const Outcome outcome = OutcomeOf(GetParam() + " --frobnicate");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("--frobnicate"));
}

std::string NameOf(const testing::TestParamInfo<std::string>& command) {
  const std::string program = command.param.substr(0, command.param.find(' '));
  return std::regex_replace(std::filesystem::path(program).filename().string(), std::regex("[^a-zA-Z0-9]"),
                            "_") +
         std::to_string(command.index);
}

INSTANTIATE_TEST_SUITE_P(Deploy, Command,
                         testing::Values(kDeploy + "run", kDeploy + "build", kDeploy + "install-packages",
                                         kDeploy + "offline-base-image", kDeploy + "package", kTests + "run",
                                         kTests + "install/run", kTests + "install/prefix",
                                         kTests + "lint/run", kTests + "docker/run", kTests + "fuzz/run",
                                         kDocs + "build", kBin + "thalweg", kBin + "thalweg run",
                                         kBin + "thalweg watch", kBin + "thalweg-make-worlds"),
                         NameOf);

TEST(DeployRun, KnowsTheOptionsOfThalwegRunAndNoOther) {
  EXPECT_EQ(OptionsIn(OutcomeOf(kDeploy + "run --help").text), [] {
    std::set<std::string> options = OptionsIn(OutcomeOf(kBin + "thalweg run --help").text);
    options.erase("--help");
    return options;
  }());
}

TEST(DeployRun, RefusesWhatItDoesNotUnderstandBeforeItBuilds) {
  EXPECT_EQ(OutcomeOf(kDeploy + "run kitchen flat").exit_code, 2);
  EXPECT_EQ(OutcomeOf(kDeploy + "run --out").exit_code, 2);
}

TEST(InstallPackages, NamesTheKindsThereAre) {
  const Outcome unknown = OutcomeOf(kDeploy + "install-packages nonsense");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.text,
              HasSubstr("unknown kind 'nonsense', there are: run build test package fuzz docker"));
  EXPECT_EQ(OutcomeOf(kDeploy + "install-packages").exit_code, 2);
}

TEST(Thalweg, NamesTheCommandsThereAre) {
  const Outcome unknown = OutcomeOf(kBin + "thalweg rum");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.text.find("thalweg: unknown command \"rum\"; the commands are run, watch"), 0U)
      << unknown.text;
  EXPECT_EQ(OutcomeOf(kBin + "thalweg").exit_code, 2);
}

TEST(Thalweg, TellsEveryMistakeInOneForm) {
  for (const char* const arguments : {"run --domain 500", "run tiny --set robot.radius_m=abc", "run nowhere",
                                      "watch --keep-going", "run a b"}) {
    const Outcome outcome = OutcomeOf(kBin + "thalweg " + arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_EQ(outcome.text.find("thalweg: "), 0U) << arguments << ": " << outcome.text;
  }
}

}  // namespace
}  // namespace thalweg::test
