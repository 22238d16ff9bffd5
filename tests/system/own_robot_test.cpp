#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

/// The robots of docs/examples, which know no partition, as docs/guide/own-robot.md builds and runs them.
class OwnRobotSystemTest : public RunSystemTest {
 protected:
  OwnRobotSystemTest() { unsetenv("THALWEG_PARTITION"); }

  void ExpectCorridorCompleted(const std::filesystem::path& robot) {
    const RunningProgram running(robot.string(), {std::to_string(place_.domain())},
                                 place_.folder() / "robot.log");
    StartScenario("own_robot", {"--without", "simulator"});
    const auto status = run_->WaitForEnd(std::chrono::seconds(200));
    ASSERT_TRUE(status) << "it still runs; " << Printed();
    EXPECT_TRUE(WIFEXITED(*status) && WEXITSTATUS(*status) == 0) << cli::DescribeEnd(*status) << "\n"
                                                                 << Printed();
    const auto report = Report();
    EXPECT_EQ(report["outcome"], "complete");
    EXPECT_EQ(report["stop_reason"], "complete");
    EXPECT_EQ(report["messages_rejected"]["total"], 0) << report["messages_rejected"];
    // The corridor has 5 x 1.6 x 1.8 m, of which the crate takes 0.5 x 0.7 x 1.1 m. Their surfaces lie
    // between voxels of 0.1 m, of which either may be the occupied one.
    EXPECT_LE(report["free_m3"], 5.0 * 1.6 * 1.8 - 0.5 * 0.7 * 1.1);
    EXPECT_GE(report["free_m3"], 4.8 * 1.4 * 1.6 - 0.7 * 0.9 * 1.3);
  }

  /// The lines of the guide that build the robot in C, for another folder.
  static std::string BuildCommands(const std::filesystem::path& folder) {
    std::ostringstream guide;
    guide << std::ifstream(SourceFolder() + "/docs/guide/own-robot.md").rdbuf();
    const std::string text = guide.str();
    const std::size_t begin = text.find("mkdir -p /tmp/my_robot");
    const std::size_t end = text.find("```", begin);
    if (begin == std::string::npos) throw std::runtime_error("the guide builds no robot");
    return std::regex_replace(text.substr(begin, end - begin), std::regex("/tmp/my_robot"), folder.string());
  }
};

TEST_F(OwnRobotSystemTest, TheRobotInCIsBuiltByTheGuidesCommandsAndCompletesItsCorridor) {
  const std::filesystem::path folder = place_.folder() / "robot";
  const std::string build = "cd '" + SourceFolder() + "' && set -e\n" + BuildCommands(folder);
  ASSERT_EQ(std::system(build.c_str()), 0) << build;
  ExpectCorridorCompleted(folder / "my_robot");
}

TEST_F(OwnRobotSystemTest, TheRobotInCppCompletesItsCorridor) {
  ExpectCorridorCompleted(std::filesystem::path(BinFolder()) / "my_robot");
}

}  // namespace
}  // namespace thalweg::test
