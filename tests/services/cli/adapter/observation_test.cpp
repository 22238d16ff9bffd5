#include "services/cli/adapter/observation.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

class ObservationTest : public testing::Test {
 protected:
  ObservationTest() { std::filesystem::create_directories(folder_); }
  ~ObservationTest() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-observation-" + std::to_string(getpid()));
};

TEST_F(ObservationTest, AScenariosNameIsThatOfItsFile) {
  EXPECT_EQ(ScenarioName("kitchen"), "kitchen");
  EXPECT_EQ(ScenarioName("deploy/scenarios/kitchen.txtpb"), "kitchen");
}

TEST_F(ObservationTest, AFolderThatHoldsARunIsRefused) {
  RunArgs args;
  args.out = (folder_ / "new").string();
  EXPECT_EQ(MakeRunFolder(args), folder_ / "new");
  EXPECT_TRUE(std::filesystem::is_directory(folder_ / "new"));
  std::ofstream(folder_ / "new" / "report.json") << "{}";
  try {
    MakeRunFolder(args);
    ADD_FAILURE() << "it was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("already holds a run (report.json)"));
  }
}

TEST_F(ObservationTest, RunsThatBeginAtTheSameTimeHaveFoldersOfTheirOwn) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directories(folder_);
  std::filesystem::current_path(folder_);
  RunArgs args;
  args.scenario = "tiny";
  std::set<std::filesystem::path> folders;
  for (int n = 0; n < 5; ++n) folders.insert(MakeRunFolder(args));
  std::filesystem::current_path(before);
  EXPECT_EQ(folders.size(), 5U);
  for (const std::filesystem::path& folder : folders) {
    EXPECT_TRUE(std::filesystem::is_directory(folder)) << folder;
    EXPECT_EQ(folder.parent_path(), folder_ / "runs");
  }
}

TEST_F(ObservationTest, MistakesOfTheSimulatorMatterOnlyWhereItTakesPart) {
  RunArgs args;
  args.scenario = "tiny";
  args.overrides = {"explorer.strategy=no_such"};
  EXPECT_THROW(ScenarioOfRun(args, Robot::kOwn), std::runtime_error);
  args.overrides = {"mapper.fill=false"};
  EXPECT_FALSE(ScenarioOfRun(args, Robot::kSimulated).mapper().fill());
}

TEST_F(ObservationTest, ARunThatIsStoppedBeforeItBeganStillLeavesItsReport) {
  RunArgs args;
  args.scenario = "tiny";
  args.domain = 1 + getpid() % 99;
  std::stop_source stop;
  stop.request_stop();
  std::ostringstream shown;
  LiveDisplay display(shown, LiveDisplay::Style::kJson, false);
  std::vector<std::string> calls;
  RunDriver driver;
  driver.introduction = "Hello.";
  driver.warnings = {"the robot floats"};
  driver.begin = [&] { calls.emplace_back("begin"); };
  driver.finish = [&] {
    calls.emplace_back("finish");
    return std::vector<std::string>{"map.ot"};
  };
  Scenario scenario = ScenarioOfRun(args, Robot::kOwn);
  scenario.mutable_network()->set_local_only(true);
  EXPECT_EQ(Observe(scenario, args, folder_, stop.get_token(), display, driver), EXIT_FAILURE);
  EXPECT_THAT(calls, testing::ElementsAre("begin", "finish"));
  nlohmann::json first, last;
  std::istringstream lines(shown.str());
  for (std::string line; std::getline(lines, line); last = nlohmann::json::parse(line)) {
    if (first.is_null()) first = nlohmann::json::parse(line);
  }
  EXPECT_EQ(first["event"], "start");
  EXPECT_EQ(last["event"], "end");
  EXPECT_EQ(last["report"]["stop_reason"], "interrupted");
  for (const char* const text : {"Hello. Ctrl-C stops", "warning: the robot floats", "not saved: map.ot"}) {
    EXPECT_THAT(shown.str(), HasSubstr(text));
  }
  const auto report = nlohmann::json::parse(std::ifstream(folder_ / "report.json"));
  EXPECT_EQ(report["scenario"], "tiny");
}

TEST_F(ObservationTest, ProgramsLearnWhyARunCannotBegin) {
  RunArgs args;
  args.json = true;
  const auto refuse = []() -> int { throw std::runtime_error("the folder is \"in use\""); };
  testing::internal::CaptureStdout();
  EXPECT_THROW(WithEvents(args, refuse), std::runtime_error);
  std::istringstream lines(testing::internal::GetCapturedStdout());
  std::vector<nlohmann::json> events;
  for (std::string line; std::getline(lines, line);) events.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0],
            nlohmann::json({{"event", "message"}, {"level", "error"}, {"text", "the folder is \"in use\""}}));
  EXPECT_EQ(events[1], nlohmann::json({{"event", "end"}, {"succeeded", false}, {"exit_code", 1}}));

  args.json = false;
  testing::internal::CaptureStdout();
  EXPECT_THROW(WithEvents(args, refuse), std::runtime_error);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(WithEvents(args, [] { return 3; }), 3);
}

}  // namespace
}  // namespace thalweg::cli
