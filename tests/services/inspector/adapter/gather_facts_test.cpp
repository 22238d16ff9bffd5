#include "services/inspector/adapter/gather_facts.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "common/base/version.h"
#include "common/dds/topic_table.h"
#include "tests/support/test_bus.h"

namespace thalweg::inspector {
namespace {

TEST(GatherFacts, APeerAndWhatDoesNotFitBetweenTwoAreAmongThem) {
  dds::Bus robot(test::BusOptionsForTest("robot"));
  dds::Bus tool(test::BusOptionsForTest("tool"));
  dds::TopicInfo odometry = dds::InfoOf<dds::topics::Odometry>();
  robot.AdvertiseBytes(odometry);
  odometry.delivery = dds::Delivery::kState;  // which the writer does not offer
  tool.SubscribeBytes(odometry, [](const dds::RawSample&) {});

  dds::BusOptions options = test::BusOptionsForTest("doctor");
  options.surveys = true;
  const Facts facts = GatherFacts(options, testing::TempDir(), {});
  EXPECT_EQ(facts.domain, options.domain);
  EXPECT_EQ(facts.kernel.wanted_socket_bytes, 4U << 20);
  EXPECT_GT(facts.out_available.value_or(0), 0U);
  const std::string process = " (" + std::to_string(getpid()) + ')';
  std::vector<std::string> names;
  for (const PeerFacts& peer : facts.peers) {
    names.push_back(peer.name);
    if (!peer.name.ends_with(process)) continue;  // another test in the same domain
    EXPECT_EQ(peer.version, Version()) << peer.name;
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"\"robot\"" + process, "\"tool\"" + process}));
  ASSERT_FALSE(facts.mismatches.empty());
  const auto findings = Diagnose(facts);
  EXPECT_TRUE(std::ranges::any_of(findings, [](const Finding& finding) {
    return finding.level == Level::kProblem && finding.subject == "QoS";
  }));
}

}  // namespace
}  // namespace thalweg::inspector
