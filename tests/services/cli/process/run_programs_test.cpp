#include "services/cli/process/run_programs.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/places.h"

namespace thalweg::cli {
namespace {

using testing::ElementsAre;

TEST(RunPrograms, AServiceIsBesideOurOwnExecutableAndGetsScenarioFolderAndDomain) {
  const Program program = ServiceProgram("visual-odometry", {.folder = "/runs/a", .domain = 7});
  EXPECT_EQ(program.name, "visual-odometry");
  EXPECT_EQ(program.executable, std::filesystem::path(test::BinFolder()) / "thalweg-visual-odometry");
  EXPECT_THAT(program.arguments,
              ElementsAre("--scenario", "/runs/a/scenario.txtpb", "--out", "/runs/a", "--domain", "7"));
  EXPECT_EQ(program.log, "/runs/a/visual-odometry.log");
  EXPECT_FALSE(program.expendable);
}

TEST(RunPrograms, TheDomainIsLeftToEnvironmentAndScenarioUnlessItIsGiven) {
  const Program program = ServiceProgram("mapper", {.folder = "/runs/a", .domain = {}});
  EXPECT_THAT(program.arguments, ElementsAre("--scenario", "/runs/a/scenario.txtpb", "--out", "/runs/a"));
}

TEST(RunPrograms, AViewIsTheGatewayWithTheScenarioAndItsOverrides) {
  const Program program = ViewProgram(
      {.scenario = "kitchen", .overrides = {"a=1", "b=2"}, .domain = 7, .announcement = "/dev/fd/3"});
  EXPECT_EQ(program.executable, std::filesystem::path(test::BinFolder()) / "thalweg-gateway");
  EXPECT_THAT(program.arguments, ElementsAre("--scenario", "kitchen", "--set", "a=1", "--set", "b=2",
                                             "--domain", "7", "--announce", "/dev/fd/3"));
  const Program plain =
      ViewProgram({.scenario = "kitchen", .overrides = {}, .domain = {}, .announcement = "/dev/fd/3"});
  EXPECT_THAT(plain.arguments, ElementsAre("--scenario", "kitchen", "--announce", "/dev/fd/3"));
}

TEST(RunPrograms, ThePortThatTheGatewayAnnouncesIsTakenOnceAndWhole) {
  const RunPlace place{
      .folder = std::filesystem::temp_directory_path() / ("thalweg-announced-" + std::to_string(getpid())),
      .domain = {}};
  std::filesystem::create_directories(place.folder);
  const Program program = GatewayProgram(place);
  ASSERT_EQ(program.arguments.at(program.arguments.size() - 2), "--announce");
  const std::string file = program.arguments.back();
  EXPECT_FALSE(TakeAnnouncedPort(place));
  std::ofstream(file) << "87";
  EXPECT_FALSE(TakeAnnouncedPort(place));
  std::ofstream(file) << "8766\n";
  EXPECT_EQ(TakeAnnouncedPort(place), 8766);
  EXPECT_FALSE(TakeAnnouncedPort(place));
  std::filesystem::remove_all(place.folder);
}

TEST(RunPrograms, TheRunGoesOnWithoutItsRecorderWhichIsOurOwnExecutable) {
  const Program program = RecorderProgram("/disk/a.mcap", {.folder = "/runs/a", .domain = 7}, "kitchen");
  EXPECT_EQ(program.executable, std::filesystem::read_symlink("/proc/self/exe"));
  EXPECT_THAT(program.arguments, ElementsAre("record", "--out", "/disk/a.mcap", "--scenario",
                                             "/runs/a/scenario.txtpb", "--name", "kitchen", "--domain", "7"));
  EXPECT_EQ(program.log, "/runs/a/recorder.log");
  EXPECT_TRUE(program.expendable);
}

}  // namespace
}  // namespace thalweg::cli
