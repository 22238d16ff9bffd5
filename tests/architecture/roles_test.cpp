#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "common/dds/topic_table.h"
#include "tests/architecture/sources.h"
#include "tests/support/places.h"

// deploy/roles.txt, from which deploy/make-keys makes permissions, and the services agree.

namespace thalweg::test {
namespace {

using Topics = std::set<std::string>;

/// What a role publishes and subscribes to.
struct Rights {
  Topics publishes;
  Topics subscribes;
};

/// The lines of deploy/roles.txt, by role.
std::map<std::string, Rights> RightsByRole() {
  std::map<std::string, Rights> rights;
  std::ifstream table(SourceFolder() + "/deploy/roles.txt");
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    std::string role;
    std::string verb;
    if (!(words >> role >> verb) || role.starts_with('#')) continue;
    Topics& topics = verb == "publishes" ? rights[role].publishes : rights[role].subscribes;
    for (std::string topic; words >> topic;) topics.insert(topic);
  }
  return rights;
}

/// Names on the wire of the structs in common/dds/topics.h.
std::map<std::string, std::string> NamesByStruct() {
  std::map<std::string, std::string> names;
  const std::regex declaration("struct (\\w+) \\{");
  const std::regex name("kName = \"([^\"]+)\"");
  std::string its_struct;
  for (const Source& source : SourcesUnder("common/dds")) {
    if (source.path != "common/dds/topics.h") continue;
    for (const std::string& line : source.lines) {
      std::smatch match;
      if (std::regex_search(line, match, declaration)) its_struct = match[1];
      if (std::regex_search(line, match, name)) names[its_struct] = match[1];
    }
  }
  return names;
}

/// What the sources of a service advertise and subscribe to.
Rights RightsUsedBy(const std::string& service) {
  const std::map<std::string, std::string> names = NamesByStruct();
  const std::regex use("(Advertise|Subscribe)\\w*<(?:dds::)?topics::(\\w+)>");
  Rights rights;
  for (const Source& source : SourcesUnder("services/" + service)) {
    if (source.path.find("/examples/") != std::string::npos) continue;
    for (const std::string& line : source.lines) {
      for (std::sregex_iterator match(line.begin(), line.end(), use), end; match != end; ++match) {
        Topics& topics = (*match)[1] == "Advertise" ? rights.publishes : rights.subscribes;
        topics.insert(names.at((*match)[2]));
      }
    }
  }
  return rights;
}

TEST(Roles, MayDoWhatTheirServicesDoAndNothingElse) {
  const std::map<std::string, Rights> rights = RightsByRole();
  for (const std::string service :
       {"simulator", "stereo", "visual_odometry", "mapper", "surface", "explorer", "controller"}) {
    const std::string role = std::regex_replace(service, std::regex("_"), "-");
    ASSERT_TRUE(rights.contains(role)) << role;
    const Rights used = RightsUsedBy(service);
    EXPECT_FALSE(used.publishes.empty()) << service;
    EXPECT_EQ(rights.at(role).publishes, used.publishes) << role;
    EXPECT_EQ(rights.at(role).subscribes, used.subscribes) << role;
  }
  // What every service does through its bus: health, its log, the second-copy check and the simulator's
  // clock.
  EXPECT_EQ(rights.at("*").publishes, (Topics{"health", "rosout"}));
  EXPECT_EQ(rights.at("*").subscribes, (Topics{"health", "clock"}));
}

TEST(Roles, APersonMayWatchEverythingAndOnlyAnOperatorCommands) {
  const std::map<std::string, Rights> rights = RightsByRole();
  const Rights used = RightsUsedBy("cli");
  for (const std::string role : {"operator", "listener", "link-onboard", "link-offboard"}) {
    EXPECT_TRUE(rights.at(role).subscribes.contains("*")) << role;
  }
  EXPECT_THAT(rights.at("operator").publishes, testing::IsSupersetOf(used.publishes));
  EXPECT_EQ(rights.at("listener").publishes, (Topics{"map/requests", "surface/requests"}));
  const Topics commands = {"explorer/path",      "command/pose",
                           "command/velocity",   "command/velocity_stamped",
                           "command/trajectory", "operator/command"};
  const std::map<std::string, Topics> commanders = {
      {"explorer", {"explorer/path"}},
      {"controller", {"command/pose", "command/velocity", "command/velocity_stamped", "command/trajectory"}},
      {"link-onboard", commands},
      {"link-offboard", commands},
      {"operator", commands}};
  for (const auto& [role, its] : rights) {
    Topics commanded;
    std::ranges::set_intersection(its.publishes, commands, std::inserter(commanded, commanded.end()));
    if (its.publishes.contains("*")) commanded = commands;
    const auto found = commanders.find(role);
    EXPECT_EQ(commanded, found == commanders.end() ? Topics{} : found->second) << role;
  }
}

TEST(Roles, AReplayMayPublishWhatIsReplayedByDefaultAndNothingElse) {
  Topics replayed;
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    if (topic.replay == dds::Replay::kByDefault) replayed.insert(topic.name);
  }
  const Rights rights = RightsByRole().at("replay");
  replayed.insert(dds::topics::ReplayStatus::kName);
  EXPECT_EQ(rights.publishes, replayed);
  // It is steered, and gives full copies of what it plays to those who ask.
  EXPECT_EQ(rights.subscribes, (Topics{dds::topics::ReplayCommands::kName, dds::topics::MapRequests::kName,
                                       dds::topics::SurfaceRequests::kName}));
}

TEST(Roles, NameOnlyTopicsThatThereAreAndLeaveNoneOut) {
  Topics known;
  for (const auto& [its_struct, name] : NamesByStruct()) known.insert(name);
  ASSERT_GT(known.size(), 20U);
  Topics named;
  for (const auto& [role, its] : RightsByRole()) {
    for (const Topics& topics : {its.publishes, its.subscribes}) named.insert(topics.begin(), topics.end());
  }
  named.erase("*");
  EXPECT_EQ(named, known);
}

}  // namespace
}  // namespace thalweg::test
