#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "common/dds/bus.h"

namespace thalweg::test {

/// Options for the buses of a test: a domain of the test's process, so that tests can run concurrently and
/// next to a robot, and a partition of the test. Domains stay below those whose ports the system assigns to
/// other sockets.
inline dds::BusOptions BusOptionsForTest(const std::string& name) {
  const testing::TestInfo* const test = testing::UnitTest::GetInstance()->current_test_info();
  dds::BusOptions options;
  options.name = name;
  options.domain = 1 + getpid() % 99;
  options.partition =
      std::string(test->test_suite_name()) + '.' + test->name() + '.' + std::to_string(getpid());
  options.publish_health = false;
  return options;
}

/// Longer than any wait takes, even on a loaded machine with sanitizers.
inline constexpr auto kPatience = std::chrono::seconds(20);

/// Waits until writer and reader are matched in both directions; from then on nothing is lost.
template <class Topic>
void AwaitMatch(dds::Bus& from, const dds::Bus::Publisher<Topic>& publisher, dds::Bus& to) {
  ASSERT_TRUE(from.SpinUntil([&] { return publisher.readers() > 0; }, kPatience)) << Topic::kName;
  ASSERT_TRUE(to.SpinUntil([&] { return to.Writers<Topic>() > 0; }, kPatience)) << Topic::kName;
}

}  // namespace thalweg::test
