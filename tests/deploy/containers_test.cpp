#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::test {
namespace {

/// The text of each service in a compose file: from its name, indented by two spaces below `services:`, to
/// the next.
std::map<std::string, std::string> ServicesIn(const std::string& file) {
  std::ifstream in(SourceFolder() + "/" + file);
  std::map<std::string, std::string> services;
  std::string* service = nullptr;
  bool below = false;
  static const std::regex kName("  ([a-z_]+):(.*)");
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line[0] != ' ' && line[0] != '#') below = line == "services:";
    std::smatch name;
    if (below && std::regex_match(line, name, kName)) service = &services[name[1]];
    if (below && service != nullptr) *service += line + '\n';
  }
  return services;
}

/// The programs that `thalweg run` starts for a scenario: "thalweg-mapper" and so on.
std::set<std::string> ProgramsOf(const std::string& scenario) {
  // Leaving out what is not there is refused with a list of what is; none of these scenarios has a surface.
  const std::string text = OutcomeOf(BinFolder() + "/thalweg run " + scenario + " --without surface").text;
  static const std::regex kProgram("[a-z-]+");
  const std::size_t begin = text.find("it has ");
  if (begin == std::string::npos) return {};
  std::set<std::string> programs;
  const std::string list = text.substr(begin + 7);
  for (std::sregex_iterator match(list.begin(), list.end(), kProgram), end; match != end; ++match) {
    if (match->str() != "and") programs.insert("thalweg-" + match->str());
  }
  return programs;
}

class Containers : public testing::TestWithParam<const char*> {};

TEST_P(Containers, HoldEveryProgramOfTheScenarioOnOneMachineAndOnTwo) {
  const auto services = ServicesIn("docker-compose.yml");
  const auto on_two_machines = ServicesIn("deploy/two-machines.yml");
  const std::set<std::string> programs = ProgramsOf(GetParam());
  ASSERT_GE(programs.size(), 4U);
  static const std::regex kStarted("profiles: \\[(sim|onboard|offboard)\\]");  // by the documented command
  for (const std::string& program : programs) {
    int found = 0;
    for (const auto& [name, text] : services) {
      if (text.find("command: " + program + ' ') == std::string::npos) continue;
      ++found;
      EXPECT_TRUE(std::regex_search(text, kStarted)) << name;
      EXPECT_TRUE(on_two_machines.contains(name)) << name << " is not in deploy/two-machines.yml";
    }
    EXPECT_EQ(found, 1) << program;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Containers,
                         testing::Values("kitchen", "kitchen_stereo", "kitchen_odometry", "kitchen_camera"),
                         [](const auto& scenario) { return std::string(scenario.param); });

TEST(ComposeFiles, OfTwoMachinesPutEachContainerOnTheMachinesNetwork) {
  const auto on_two_machines = ServicesIn("deploy/two-machines.yml");
  EXPECT_EQ(on_two_machines.size(), ServicesIn("docker-compose.yml").size());
  for (const auto& [name, text] : on_two_machines) {
    EXPECT_NE(text.find("network_mode: host"), std::string::npos) << name;
  }
}

TEST(ComposeFiles, StartEveryServiceAgainAndCheckItsHealthByItsOwnProgram) {
  static const std::regex kProgram("command: (thalweg-[a-z-]+(?: --side [a-z]+)?)");
  int services = 0;
  for (const auto& [name, text] : ServicesIn("docker-compose.yml")) {
    std::smatch program;
    if (!std::regex_search(text, program, kProgram)) continue;  // watch, which ends with the run
    ++services;
    EXPECT_NE(text.find("<<: *lasting"), std::string::npos) << name;
    const std::string words = std::regex_replace(program[1].str(), std::regex(" "), ", ");
    EXPECT_NE(text.find("test: [CMD, " + words + ", --healthy,"), std::string::npos) << name;
  }
  EXPECT_GE(services, 9);
}

TEST(ComposeFiles, WithKeysGiveEachContainerThoseOfItsOwnRole) {
  const auto services = ServicesIn("docker-compose.yml");
  const auto secured = ServicesIn("deploy/secure.yml");
  // The two sides of a link have a role each.
  static const std::regex kProgram("command: thalweg(-[a-z-]+)? (?:--side ([a-z]+))?");
  static const std::regex kRole("THALWEG_SECURITY\\}/([a-z-]+):/keys/([a-z-]+):ro");
  for (const auto& [name, text] : services) {
    std::smatch program;
    ASSERT_TRUE(std::regex_search(text, program, kProgram)) << name;
    std::string own = program[1].matched ? program[1].str().substr(1) : "operator";
    if (own == "gateway") own = "operator";  // as which it acts
    if (program[2].matched) own.append("-").append(program[2].str());
    ASSERT_TRUE(secured.contains(name)) << name << " would start without keys";
    const std::string& keys = secured.at(name);
    std::smatch role;
    ASSERT_TRUE(std::regex_search(keys, role, kRole)) << name;
    EXPECT_EQ(role[1], own) << name;
    EXPECT_EQ(role[2], own) << name;
  }
  EXPECT_EQ(secured.size(), services.size());
}

}  // namespace
}  // namespace thalweg::test
