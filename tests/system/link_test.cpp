#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tests/system/processes.h"

namespace thalweg::test {
namespace {

using std::chrono_literals::operator""s;
using testing::HasSubstr;
using testing::Not;

/// The robot's services in one domain, the base station's in the next, thalweg-link on both sides.
class LinkSystemTest : public testing::Test {
 protected:
  std::unique_ptr<RunningProgram> Start(const std::string& side, const std::string& program,
                                        std::vector<std::string> arguments) const {
    const int domain = place_.domain() + (side == "base" ? 1 : 0);
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain), "--set",
                                       "link.domain=" + std::to_string(place_.domain() + 2), "--set",
                                       "simulator.time_scale=4", "--out", place_.folder() / side});
    return std::make_unique<RunningProgram>(program, std::move(arguments), Log(side, program));
  }
  std::string Printed(const std::string& side, const std::string& program) const {
    std::ostringstream text;
    text << std::ifstream(Log(side, program)).rdbuf();
    return text.str();
  }
  std::filesystem::path Log(const std::string& side, const std::string& program) const {
    return place_.folder() / (side + "-" + program + ".log");
  }

  OwnPlace place_;
};

TEST_F(LinkSystemTest, ARoomIsExploredThroughThePairOfLinks) {
  const std::vector<std::string> scenario = {"--scenario", "tiny"};
  const auto simulator = Start("robot", "thalweg-simulator", scenario);
  const auto controller = Start("robot", "thalweg-controller", scenario);
  const auto onboard = Start("robot", "thalweg-link", {"--scenario", "tiny", "--side", "onboard"});
  const auto mapper = Start("base", "thalweg-mapper", scenario);
  const auto explorer = Start("base", "thalweg-explorer", scenario);
  const auto offboard = Start("base", "thalweg-link", {"--scenario", "tiny", "--side", "offboard"});
  const auto watch = Start("base", "thalweg", {"watch", "tiny"});
  EXPECT_EQ(watch->WaitForEnd(90s), 0) << Printed("base", "thalweg");
  EXPECT_THAT(Printed("base", "thalweg"), HasSubstr("complete"));
  for (const char* const side : {"robot", "base"}) {
    EXPECT_THAT(Printed(side, "thalweg-link"), Not(HasSubstr("frames rejected")));
    EXPECT_THAT(Printed(side, "thalweg-link"), Not(HasSubstr("lost")));
  }
}

}  // namespace
}  // namespace thalweg::test
