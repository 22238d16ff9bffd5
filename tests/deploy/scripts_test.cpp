#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
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

TEST(PageBundle, ThatNpmsRegistryCannotBeReachedIsReportedAndCostsOnlyThePage) {
  const std::filesystem::path folder = testing::TempDir() + "/bundle-" + std::to_string(getpid());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "page");  // of an earlier build
  std::filesystem::create_directories(folder / "share");
  std::ofstream(folder / "page" / "index.html") << "old";
  std::ofstream(folder / "share" / "report.html") << "old";
  const std::filesystem::path npm = folder / "npm";
  std::ofstream(npm)
      << "#!/bin/sh\necho 'network request to https://registry.npmjs.org failed' >&2\nexit 1\n";
  std::filesystem::permissions(npm, std::filesystem::perms::owner_all);
  const std::string page = SourceFolder() + "/services/gateway/page";
  const Outcome outcome =
      OutcomeOf("cmake -DNPM='" + npm.string() + "' -DSOURCE='" + page + "' -DWORK='" +
                (folder / "work").string() + "' -DOUTPUT='" + (folder / "page").string() + "' -DREGISTRY='" +
                SourceFolder() + "/services/explorer/core/strategy/registry.cpp' -DREPORT='" +
                SourceFolder() + "/services/cli/page' -DREPORT_OUTPUT='" + (folder / "share").string() +
                "' -P '" + page + "/bundle.cmake'");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("The gateway's page and the template of report.html were not built"));
  EXPECT_THAT(outcome.text, HasSubstr("network request to https://registry.npmjs.org failed"));
  EXPECT_FALSE(std::filesystem::exists(folder / "page")) << "an old page would be taken for a new one";
  EXPECT_FALSE(std::filesystem::exists(folder / "share" / "report.html"));
  std::filesystem::remove_all(folder);
}

// `tests/run --only` reads them before anything is built.
TEST(TestList, NamesSourcesThatExist) {
  std::ifstream list(BinFolder() + "/../tests.txt");
  int sources = 0;
  for (std::string line; std::getline(list, line);) {
    std::istringstream names(line.substr(line.rfind('|') + 1));
    for (std::string name; names >> name; ++sources) {
      EXPECT_TRUE(std::filesystem::exists(name)) << line;
    }
  }
  EXPECT_GT(sources, 100);
}

class Command : public testing::TestWithParam<std::string> {};

TEST_P(Command, ReportsWhatItDoesWhenAskedForHelp) {
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
                                         kDeploy + "offline-base-image", kDeploy + "package",
                                         kDeploy + "make-keys", kTests + "run", kTests + "install/run",
                                         kTests + "install/prefix", kTests + "lint/run",
                                         kTests + "docker/run", kTests + "fuzz/run", kTests + "network/run",
                                         kTests + "security/storm", SourceFolder() + "/.ci/run",
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
  const Outcome misspelled = OutcomeOf(kDeploy + "run kichen");
  EXPECT_EQ(misspelled.exit_code, 2);
  EXPECT_THAT(misspelled.text,
              HasSubstr("run: no scenario kichen: neither a file nor one of bridge car comb"));
}

/// Permissions of a file or folder, e.g. "600".
std::string ModeOf(const std::filesystem::path& path) {
  return OutcomeOf("stat -c %a '" + path.string() + "'").text.substr(0, 3);
}

TEST(MakeKeys, WritesKeysForTheirOwnerOnlyAndKeepsThoseThereAre) {
  if (OutcomeOf("command -v openssl").exit_code != 0) GTEST_SKIP() << "openssl is not installed";
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / ("make-keys-" + std::to_string(getpid()));
  fs::remove_all(folder);
  const std::string make_keys = kDeploy + "make-keys '" + folder.string() + "' --role mapper";
  const Outcome made = OutcomeOf(make_keys);
  ASSERT_EQ(made.exit_code, 0) << made.text;
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    EXPECT_EQ(ModeOf(entry.path()), entry.is_directory() ? "700" : "600") << entry.path();
    if (entry.is_regular_file()) ++files;
  }
  EXPECT_EQ(files, 6);
  const auto checksums = [&] {
    return OutcomeOf("{ cat '" + folder.string() + "'/*.p* '" + folder.string() + "'/*/* | sha256sum; }")
        .text;
  };
  const std::string before = checksums();

  const Outcome again = OutcomeOf(make_keys);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.text, HasSubstr("/mapper exists; --force replaces its keys"));
  EXPECT_EQ(checksums(), before);

  EXPECT_EQ(OutcomeOf(make_keys + " --force").exit_code, 0);
  EXPECT_NE(checksums(), before);
  const auto verify = [&] {
    return OutcomeOf("openssl verify -CAfile '" + folder.string() + "/ca.pem' '" + folder.string() +
                     "/mapper/certificate.pem'");
  };
  EXPECT_EQ(verify().exit_code, 0) << verify().text;
  fs::remove_all(folder);
}

TEST(MakeKeys, RefusesNamesAndNumbersThatAreNone) {
  const std::string folder = " '" + testing::TempDir() + "/never-made' ";
  for (const std::string options :
       {"--role captain", "--role ../mapper", "--role", "--days 0", "--days ten", "--days 5000",
        "--from yesterday", "--from 2026-13-45", "--role mapper another-folder", "--roles"}) {
    const Outcome outcome = OutcomeOf(kDeploy + "make-keys" + folder + options);
    EXPECT_EQ(outcome.exit_code, 2) << options << ": " << outcome.text;
    EXPECT_THAT(outcome.text, testing::StartsWith("make-keys: ")) << options;
  }
  EXPECT_EQ(OutcomeOf(kDeploy + "make-keys").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(testing::TempDir() + "/never-made"));
}

TEST(InstallPackages, NamesTheKindsThereAre) {
  const Outcome unknown = OutcomeOf(kDeploy + "install-packages nonsense");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(
      unknown.text,
      HasSubstr("unknown kind 'nonsense', there are: run build test package fuzz page tools docker router"));
  EXPECT_EQ(OutcomeOf(kDeploy + "install-packages").exit_code, 2);
}

TEST(DeployBuild, ItsHelpListsThePresetsThereAre) {
  std::ifstream file(SourceFolder() + "/CMakePresets.json");
  std::ostringstream content;
  content << file.rdbuf();
  const std::string presets = content.str();
  const std::string help = OutcomeOf(kDeploy + "build --help").text;
  static const std::regex kPreset("\"name\": \"(\\w+)\",\\s*\"configurePreset\"");
  const std::sregex_iterator first(presets.begin(), presets.end(), kPreset);
  ASSERT_GE(std::distance(first, {}), 2);
  for (auto preset = first; preset != std::sregex_iterator(); ++preset) {
    EXPECT_TRUE(std::regex_search(help, std::regex("\\b" + preset->str(1) + "\\b"))) << preset->str(1);
  }
}

/// A copy of .ci/run whose steps are replaced by scripts that end with a given code.
class CiRun : public testing::Test {
 protected:
  CiRun() : folder_(testing::TempDir() + "thalweg_ci_" + std::to_string(getpid())) {
    std::filesystem::create_directories(folder_ / ".ci");
    std::filesystem::copy_file(SourceFolder() + "/.ci/run", folder_ / ".ci/run");
    for (const char* const step :
         {"tests/run", "docs/build", "tests/lint/run", "tests/fuzz/run", "tests/install/run",
          "tests/tools/run", "tests/docker/run", "deploy/build"})
      EndsWith(step, 0);
  }
  ~CiRun() override { std::filesystem::remove_all(folder_); }

  void EndsWith(const std::string& step, int code, const std::string& words = "done") {
    const std::filesystem::path script = folder_ / step;
    std::filesystem::create_directories(script.parent_path());
    std::ofstream(script) << "#!/bin/sh\necho " << words << "\nexit " << code << '\n';
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  }
  Outcome Run(const std::string& arguments = "", int minutes = 58) const {
    return OutcomeOf("THALWEG_CI_MINUTES=" + std::to_string(minutes) + " " + (folder_ / ".ci/run").string() +
                     " " + arguments);
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(CiRun, PassesIfEveryStepPasses) {
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.text.ends_with("== passed\n")) << outcome.text;
}

TEST_F(CiRun, FailsAndShowsWhatTheStepThatFailedPrintedLast) {
  EndsWith("docs/build", 1, "what went wrong");
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("== the last lines of docs:\nwhat went wrong\n"));
  EXPECT_TRUE(outcome.text.ends_with("== FAILED: docs\n")) << outcome.text;
}

TEST_F(CiRun, NamesTheStepForWhichTheMachineLacksSomething) {
  EndsWith("tests/docker/run", 77);
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.text.ends_with("== passed, but skipped: docker\n")) << outcome.text;
}

TEST_F(CiRun, AStepWithoutTimeIsNamedAndAFailureOnlyIfStrict) {
  const Outcome outcome = Run("", 11);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("fuzz       NOT RUN: needs up to 14 minutes, 11 of 11 are left"));
  EXPECT_TRUE(outcome.text.ends_with("== INCOMPLETE: no time was left for: lint tools fuzz benchmarks\n"))
      << outcome.text;
  EXPECT_EQ(Run("--strict", 11).exit_code, 1);
  EXPECT_EQ(Run("--strict tests docs", 11).exit_code, 0) << "fuzz is not among the steps";
  EndsWith("docs/build", 1);
  EXPECT_EQ(Run("", 11).exit_code, 1);
}

TEST_F(CiRun, TheContainersHaveCamerasWhereThereIsTimeForThem) {
  EXPECT_THAT(Run("docker", 19).text, HasSubstr("build-dev kitchen_camera\n"));
  EXPECT_THAT(Run("docker", 17).text, HasSubstr("build-dev kitchen\n"));
  EXPECT_THAT(Run("docker", 7).text, HasSubstr("docker     NOT RUN: needs up to 8 minutes"));
}

/// tests/tools/run with stand-ins: a build whose run says what it has to say and goes on, and a Node.js that
/// does what a test wants.
class ToolsRun : public testing::Test {
 protected:
  ToolsRun() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "bin");
    std::filesystem::create_directories(folder_ / "tmp");
    Write("bin/thalweg", "echo 'the gateway has no port'; exec tail -f /dev/null");
    for (const char* const name : {"bin/thalweg-gateway", "bin/npm", "bin/chromium"}) Write(name, "true");
  }
  ~ToolsRun() override { std::filesystem::remove_all(folder_); }
  void Write(const std::string& name, const std::string& script) {
    std::ofstream(folder_ / name) << "#!/bin/bash\n" << script << "\n";
    std::filesystem::permissions(folder_ / name, std::filesystem::perms::owner_all);
  }
  Outcome Run(const std::string& node) {
    Write("bin/node", node);
    return OutcomeOf("PATH=" + (folder_ / "bin").string() + ":$PATH TMPDIR=" + (folder_ / "tmp").string() +
                     " " + kTests + "tools/run " + folder_.string() + " channels");
  }
  bool LeftSomething() const { return !std::filesystem::is_empty(folder_ / "tmp"); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-tools-" + std::to_string(getpid()));
};

TEST_F(ToolsRun, APartThatFailsKeepsItsFilesAndShowsTheEndsOfTheLogs) {
  // The log is written by a process beside: wait until it is.
  const Outcome outcome =
      Run("until grep -qs port \"${0%/bin/node}\"/tmp/*/channels.log; do :; done; exit 1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("the gateway has no port"));
  EXPECT_THAT(outcome.text, HasSubstr("failed in channels; logs and screenshots are in"));
  EXPECT_TRUE(LeftSomething());
}

TEST_F(ToolsRun, APartThatPassesLeavesNothing) {
  const Outcome outcome = Run("exit 0");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_FALSE(LeftSomething());
}

TEST(Thalweg, NamesTheCommandsThereAre) {
  const Outcome unknown = OutcomeOf(kBin + "thalweg rum");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(
      unknown.text.find("thalweg: unknown command \"rum\"; did you mean run?; the commands are run, watch"),
      0U)
      << unknown.text;
  const Outcome deeper = OutcomeOf(kBin + "thalweg send replay pauze");
  EXPECT_EQ(deeper.exit_code, 2);
  EXPECT_EQ(deeper.text.find(
                "thalweg: unknown command \"pauze\"; did you mean pause?; the commands are pause, resume"),
            0U)
      << deeper.text;
  const Outcome missing = OutcomeOf(kBin + "thalweg bag");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_EQ(missing.text.find("thalweg: a command is missing; the commands are info"), 0U) << missing.text;
  EXPECT_EQ(OutcomeOf(kBin + "thalweg").exit_code, 2);
}

TEST(Thalweg, ReportsEveryMistakeInOneForm) {
  for (const char* const arguments : {"run --domain 500", "run tiny --set robot.radius_m=abc", "run nowhere",
                                      "watch --keep-going", "run a b"}) {
    const Outcome outcome = OutcomeOf(kBin + "thalweg " + arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_EQ(outcome.text.find("thalweg: "), 0U) << arguments << ": " << outcome.text;
  }
}

}  // namespace
}  // namespace thalweg::test
