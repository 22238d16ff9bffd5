#include "services/inspector/core/diagnosis.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;

/// A machine and a bus on which nothing is wrong.
Facts GoodFacts() {
  Facts facts;
  facts.kernel = {.rmem_max = 4U << 20,
                  .wmem_max = 8U << 20,
                  .ipfrag_high_thresh = 4U << 20,
                  .wanted_socket_bytes = 4U << 20};
  facts.shared_memory.is_there = facts.shared_memory.is_writable = true;
  facts.shared_memory.owner = "root";
  facts.shared_memory.user = "ada";
  facts.shared_memory.size = facts.shared_memory.available = 8'000'000'000;
  facts.shared_memory.segment = 64'000'000;
  facts.interfaces = {
      {.name = "lo", .address = "127.0.0.1", .is_loopback = true},
      {.name = "eth0", .address = "10.0.0.7", .has_multicast = true, .hears_own_multicast = true}};
  facts.domain = 3;
  facts.domains_in_use = {{3, {"thalweg-mapper (12)"}}};
  facts.peers = {{"\"mapper\" (12)", "1.2.3"}};
  facts.version = "1.2.3";
  facts.out_folder = "runs";
  facts.out_available = 50'000'000'000;
  return facts;
}

/// The findings that are not ok.
std::vector<Finding> Complaints(const Facts& facts) {
  std::vector<Finding> findings = Diagnose(facts);
  std::erase_if(findings, [](const Finding& finding) { return finding.level == Level::kOk; });
  return findings;
}

/// The only complaint about these facts.
Finding ComplaintAbout(const Facts& facts) {
  const std::vector<Finding> complaints = Complaints(facts);
  EXPECT_EQ(complaints.size(), 1U);
  return complaints.empty() ? Finding() : complaints[0];
}

TEST(Diagnosis, WhereAllIsWellEachSubjectIsOk) {
  EXPECT_TRUE(Complaints(GoodFacts()).empty());
  std::vector<std::string> subjects;
  for (const Finding& finding : Diagnose(GoodFacts())) subjects.push_back(finding.subject);
  for (const char* const subject :
       {"version", "domain", "discovery", "QoS", "network", "socket buffers", "shared memory", "disk"}) {
    EXPECT_THAT(subjects, testing::Contains(subject));
  }
}

TEST(Diagnosis, EveryComplaintSaysWhatToDo) {
  Facts facts;  // of a machine that has nothing
  facts.discovery_servers = {{0, "10.0.0.1:11811"}};
  facts.ros_domain_id = "5";
  facts.mismatches = {
      {"odometry", "\"a\" offers best effort, \"b\" requests reliable: nothing passes", "do this"}};
  facts.clocks = {{"robot", -0.2, 3}};
  for (const Finding& finding : Complaints(facts)) {
    if (finding.text.find("cannot be read") == std::string::npos) {
      EXPECT_FALSE(finding.advice.empty()) << finding.subject << ": " << finding.text;
    }
  }
}

TEST(Diagnosis, SmallSocketBuffersComeWithTheCommandThatRaisesThem) {
  Facts facts = GoodFacts();
  facts.kernel.rmem_max = 212992;
  const Finding finding = ComplaintAbout(facts);
  EXPECT_EQ(finding.level, Level::kNote);
  EXPECT_THAT(finding.text, HasSubstr("grants 0.2 MB of the 4.2 MB"));
  EXPECT_EQ(finding.advice, "sysctl -w net.core.rmem_max=4194304");
}

TEST(Diagnosis, SharedMemoryThatIsTooSmallForOneProcessIsAProblemAndForARunANote) {
  Facts facts = GoodFacts();
  facts.shared_memory.size = 64 << 20;
  facts.shared_memory.available = 60'000'000;
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kProblem);
  facts.shared_memory.available = 64'000'000;
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kNote);
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("8 processes with large messages may need 512 MB"));
  facts.shared_memory.is_used = false;
  EXPECT_TRUE(Complaints(facts).empty());
}

TEST(Diagnosis, SharedMemoryThatIsAbsentOrClosedIsAProblem) {
  Facts facts = GoodFacts();
  facts.shared_memory.is_writable = false;
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kProblem);
  EXPECT_EQ(ComplaintAbout(facts).text, "/dev/shm belongs to root, and ada cannot write there");
  facts.shared_memory.is_there = false;
  EXPECT_EQ(ComplaintAbout(facts).text, "there is no /dev/shm");
}

TEST(Diagnosis, LeftoversAndOtherUsersOfSharedMemoryAreNamed) {
  Facts facts = GoodFacts();
  facts.shared_memory.stale_files = 3;
  facts.shared_memory.stale_bytes = 12'000'000;
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("left 3 files with 12 MB"));
  facts = GoodFacts();
  facts.shared_memory.other_owners = {"bob", "root"};
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("bob, root have DDS files"));
  EXPECT_THAT(ComplaintAbout(facts).advice, HasSubstr("as ada"));
}

TEST(Diagnosis, AnInterfaceWithoutWorkingMulticastIsNamed) {
  Facts facts = GoodFacts();
  facts.interfaces[1].hears_own_multicast = false;
  EXPECT_THAT(ComplaintAbout(facts).advice, HasSubstr("ip route add 224.0.0.0/4 dev eth0"));
  facts.interfaces[1].has_multicast = false;
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("eth0 10.0.0.7 has no multicast"));
  facts.interfaces.resize(1);
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("no network but this machine's own"));
}

TEST(Diagnosis, AnotherDomainOfRosAndAnEmptyOneAreNoted) {
  Facts facts = GoodFacts();
  facts.ros_domain_id = "5";
  EXPECT_EQ(ComplaintAbout(facts).advice, "export THALWEG_DOMAIN=5");
  facts.ros_domain_id = "3";
  EXPECT_TRUE(Complaints(facts).empty());
  facts.peers.clear();
  EXPECT_EQ(ComplaintAbout(facts).text, "0 participants in domain 3");
}

TEST(Diagnosis, DomainsOfOthersAreToldWithTheirProcesses) {
  Facts facts = GoodFacts();
  facts.domains_in_use = {{0, {}}, {3, {"a (1)", "b (2)"}}};
  std::vector<std::string> texts;
  for (const Finding& finding : Diagnose(facts)) texts.push_back(finding.text);
  EXPECT_THAT(texts, testing::Contains(
                         "0 is used on this machine by processes of other users, not the one examined here"));
  EXPECT_THAT(texts, testing::Contains("3 is used on this machine by a (1), b (2)"));
}

TEST(Diagnosis, AServerThatDoesNotAnswerIsAProblem) {
  Facts facts = GoodFacts();
  facts.discovery_servers = {{0, "10.0.0.1:12000"}};
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kProblem);
  EXPECT_THAT(ComplaintAbout(facts).advice, HasSubstr("fast-discovery-server -i 0 -l ADDRESS -p 12000"));
  facts.discovery_servers_answering = 1;
  EXPECT_TRUE(Complaints(facts).empty());
  facts.discovery_servers.push_back({2, "10.0.0.2:12000"});
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("only 1 of 2 answers"));
  EXPECT_THAT(ComplaintAbout(facts).advice, HasSubstr("fast-discovery-server -i 2 -l ADDRESS -p 12000"));
  facts.discovery_servers_answering = 2;
  EXPECT_TRUE(Complaints(facts).empty());
}

TEST(Diagnosis, NamesTheMachinesThatAreAnnouncedTo) {
  Facts facts = GoodFacts();
  facts.named_peers = "10.0.0.2,base";
  std::vector<std::string> texts;
  for (const Finding& finding : Diagnose(facts)) texts.push_back(finding.text);
  EXPECT_THAT(texts, testing::Contains("by multicast, and at 10.0.0.2,base"));
  EXPECT_TRUE(Complaints(facts).empty());
}

TEST(Diagnosis, PeersOfAnotherVersionAndQosThatDoesNotFitAreProblems) {
  Facts facts = GoodFacts();
  facts.peers.push_back({"\"explorer\" (13)", "1.1.0"});
  facts.peers.push_back({"\"driver\" (14)", ""});  // none of ours
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kProblem);
  EXPECT_EQ(ComplaintAbout(facts).text, "thalweg 1.2.3; \"explorer\" (13) is of 1.1.0");
  facts = GoodFacts();
  facts.mismatches = {{"odometry", "text", "advice"}};
  EXPECT_EQ(ComplaintAbout(facts).text, "odometry: text");
}

TEST(Diagnosis, ClocksThatDifferAreNotedFrom5MillisecondsAndAProblemFrom50) {
  const auto level = [](double difference) {
    Facts facts = GoodFacts();
    facts.clocks = {{"robot", difference, 4}};
    const std::vector<Finding> complaints = Complaints(facts);
    return complaints.empty() ? Level::kOk : complaints[0].level;
  };
  EXPECT_EQ(level(0.004), Level::kOk);
  EXPECT_EQ(level(-0.006), Level::kNote);
  EXPECT_EQ(level(0.051), Level::kProblem);
  Facts facts = GoodFacts();
  facts.clocks = {{"robot", -0.2, 4}};
  EXPECT_EQ(ComplaintAbout(facts).text, "robot is 200.0 ms ahead of this machine, by 4 messages of health");
}

TEST(Diagnosis, ClocksThatCannotBeComparedAreNamedAndSimulatedTimeIsReported) {
  const auto about_clocks = [](const Facts& facts) {
    std::string text;
    for (const Finding& finding : Diagnose(facts)) {
      if (finding.subject == "clocks") text += finding.text + '\n';
    }
    return text;
  };
  Facts facts = GoodFacts();
  EXPECT_THAT(about_clocks(facts), HasSubstr("nobody publishes a clock"));
  facts.run_clock_ahead_s = 0.01;
  EXPECT_THAT(about_clocks(facts), HasSubstr("which is this machine's time"));
  facts.run_clock_ahead_s = -1.7e9;
  EXPECT_THAT(about_clocks(facts), HasSubstr("the run has simulated time"));
  EXPECT_TRUE(Complaints(facts).empty());
  facts.uncompared_hosts = {"camera-box"};
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kNote);
  EXPECT_THAT(ComplaintAbout(facts).text, HasSubstr("camera-box has sent no message of health"));
}

TEST(Diagnosis, ATopicWithoutItsPrefixIsAProblemWithTheNameThatItMustHave) {
  Facts facts = GoodFacts();
  facts.misnamed = {{.participant = "\"driver\" (7)", .writes = true, .topic = "pose", .meant = "xx/pose"}};
  const Finding finding = ComplaintAbout(facts);
  EXPECT_EQ(finding.level, Level::kProblem);
  EXPECT_EQ(finding.text,
            "\"driver\" (7) publishes pose on the wire, which nobody hears: the topic is xx/pose there");
  EXPECT_THAT(finding.advice, HasSubstr("xx/pose"));
}

TEST(Diagnosis, ADiskThatIsAlmostFullIsNotedAndAFullOneAProblem) {
  Facts facts = GoodFacts();
  facts.out_available = 2'000'000'000;
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kNote);
  facts.out_available = 50'000'000;
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kProblem);
  facts.out_available.reset();
  EXPECT_EQ(ComplaintAbout(facts).level, Level::kProblem);
}

}  // namespace
}  // namespace thalweg::inspector
