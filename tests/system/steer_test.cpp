#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

using std::chrono_literals::operator""s;

class SteeredRun : public RunSystemTest {
 protected:
  /// Runs `thalweg send ARGUMENTS`, and returns its exit code and what it printed.
  std::pair<int, std::string> Send(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "send");
    const std::filesystem::path screen = place_.folder() / "send.txt";
    RunningProgram send("thalweg", arguments, screen);
    const auto status = send.WaitForEnd(60s);
    std::ostringstream text;
    text << std::ifstream(screen).rdbuf();
    return {status && WIFEXITED(*status) ? WEXITSTATUS(*status) : -1, text.str()};
  }
  void Accepted(const std::vector<std::string>& arguments) {
    const auto [code, text] = Send(arguments);
    EXPECT_EQ(code, 0) << text;
  }
};

TEST_F(SteeredRun, AKitchenIsPausedResumedAndLeftForHome) {
  StartScenario("kitchen");
  ASSERT_TRUE(Until([&] { return OnTheWay(); })) << Printed();

  Accepted({"pause"});
  ASSERT_TRUE(Until([&] { return exploration_->state() == thalweg_msgs::msg::EXPLORATION_PAUSED; }));
  const auto paused_at = simulation_->header().stamp();
  // From a second after the pause on, the robot stands.
  std::optional<double> stood;
  bool moved = false;
  ASSERT_TRUE(Until([&] {
    const double since = static_cast<double>(simulation_->header().stamp().sec() - paused_at.sec());
    if (since < 2.0) return false;
    if (!stood) stood = simulation_->distance_m();
    moved = moved || simulation_->distance_m() > *stood + 0.01;
    return since > 5.0;
  }));
  EXPECT_FALSE(moved);

  const auto [refused, why] = Send({"goto", "900", "900", "900"});
  EXPECT_EQ(refused, 1);
  EXPECT_NE(why.find("refused: the goal"), std::string::npos) << why;
  Accepted({"save-map"});
  EXPECT_TRUE(std::filesystem::exists(Out() / "map.bt"));

  Accepted({"resume"});
  const double before = simulation_->distance_m();
  ASSERT_TRUE(Until([&] { return simulation_->distance_m() > before + 0.1; })) << "it goes on";
  Accepted({"home"});
  const auto status = run_->WaitForEnd(120s);
  ASSERT_TRUE(status) << Printed();
  EXPECT_EQ(Report()["stop_reason"], "ended by the operator");
  EXPECT_EQ(Report()["true_collisions"], 0);
}

TEST_F(SteeredRun, IsEndedByStopAndTheExplorersLogNamesWhoSentIt) {
  StartScenario("kitchen");
  ASSERT_TRUE(Until([&] { return OnTheWay(); })) << Printed();
  Accepted({"stop"});
  ASSERT_TRUE(run_->WaitForEnd(60s)) << Printed();
  EXPECT_EQ(Report()["stop_reason"], "ended by the operator");
  std::ostringstream log;
  log << std::ifstream(Out() / "explorer.log").rdbuf();
  EXPECT_THAT(log.str(),
              testing::ContainsRegex("command [0-9]+ of thalweg send of [^ ]+@[^ ]+ [(][0-9]+[)]: "));
}

}  // namespace
}  // namespace thalweg::test
