#include "services/cli/adapter/run_plan.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "services/mapper/adapter/mapper_service.h"

namespace thalweg::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(RunPlan, AScenariosSourcesDecideWhichServicesItNeeds) {
  Scenario scenario;
  EXPECT_THAT(ServicesOf(scenario), ElementsAre("mapper", "explorer", "controller", "simulator"));
  scenario.set_depth_source(DepthSource::STEREO);
  scenario.set_odometry_source(OdometrySource::VISUAL_ODOMETRY);
  EXPECT_THAT(ServicesOf(scenario),
              ElementsAre("stereo", "mapper", "explorer", "controller", "visual-odometry", "simulator"));
}

TEST(RunPlan, AServiceThatIsLeftOutMustBeOneOfTheScenarios) {
  const Scenario scenario;
  EXPECT_THAT(ServicesOf(scenario, {"explorer"}), ElementsAre("mapper", "controller", "simulator"));
  try {
    ServicesOf(scenario, {"stereo"});
    ADD_FAILURE() << "it was left out";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(
        error.what(),
        "--without stereo: the scenario has no such service; it has mapper, explorer, controller and "
        "simulator");
  }
}

TEST(RunPlan, WhoWatchesWaitsForTheServicesAndARobot) {
  EXPECT_EQ(NeedsText({}), "mapper, explorer, controller and a robot");
}

TEST(RunPlan, ARunKeepsToThisMachineUnlessANetworkIsNamed) {
  for (const char* name : {"THALWEG_INTERFACE", "THALWEG_DISCOVERY_SERVER", "THALWEG_PEERS"}) unsetenv(name);
  Scenario scenario;
  KeepToThisMachine(scenario, false);
  EXPECT_FALSE(scenario.network().has_local_only()) << "others are expected";
  KeepToThisMachine(scenario, true);
  EXPECT_TRUE(scenario.network().local_only());
  Scenario open;
  open.mutable_network()->set_local_only(false);
  KeepToThisMachine(open, true);
  EXPECT_FALSE(open.network().local_only());
  Scenario named;
  named.mutable_network()->set_peers("base");
  KeepToThisMachine(named, true);
  EXPECT_FALSE(named.network().has_local_only());
}

TEST(RunPlan, TheControllerChecksPathsBesideTheMapperUnlessTheScenarioSaysElse) {
  Scenario scenario;
  CheckPathsWithMapper(scenario, {"explorer"});
  EXPECT_FALSE(scenario.controller().has_check_paths());
  CheckPathsWithMapper(scenario, {"mapper", "explorer"});
  EXPECT_TRUE(scenario.controller().check_paths());
  scenario.mutable_controller()->set_check_paths(false);
  CheckPathsWithMapper(scenario, {"mapper"});
  EXPECT_FALSE(scenario.controller().check_paths());
}

TEST(RunPlan, IntroducesWhatItStartsAndWhatIsSpecial) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("thalweg-run-plan-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  Scenario scenario;
  EXPECT_EQ(IntroductionText(scenario, {}, false, folder),
            "Starting mapper, explorer, controller and simulator.");
  EXPECT_EQ(IntroductionText(scenario, {}, true, folder),
            "Starting mapper, explorer, controller, simulator and surface.");
  EXPECT_THAT(IntroductionText(scenario, {"explorer"}, false, folder),
              HasSubstr("Expecting explorer to be started elsewhere."));
  EXPECT_THAT(IntroductionText(scenario, {"simulator"}, false, folder),
              AllOf(HasSubstr("Expecting a robot: odometry and depth/points"), Not(HasSubstr("elsewhere"))));
  scenario.mutable_network()->set_local_only(true);
  EXPECT_THAT(IntroductionText(scenario, {}, false, folder), HasSubstr("Other machines are ignored"));
  EXPECT_THAT(IntroductionText(scenario, {}, false, folder), Not(HasSubstr("resumes")));
  std::ofstream(folder / mapper::MapperService::kCheckpointFile) << "map";
  EXPECT_THAT(IntroductionText(scenario, {}, false, folder), HasSubstr("resumes from checkpoint.map"));
  std::filesystem::remove_all(folder);
}

TEST(RunPlan, ListsNamesAsASentenceDoes) {
  EXPECT_EQ(Listed({}), "");
  EXPECT_EQ(Listed({"a"}), "a");
  EXPECT_EQ(Listed({"a", "b"}), "a and b");
  EXPECT_EQ(Listed({"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace thalweg::cli
