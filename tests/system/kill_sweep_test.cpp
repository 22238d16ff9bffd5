#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

/// Which service is killed, and the number of the attempt.
class KillSweep : public RunSystemTest, public testing::WithParamInterface<std::tuple<const char*, int>> {};

TEST_P(KillSweep, RunIsCompletedAlthoughAServiceIsKilledAtARandomMoment) {
  const auto& [service, seed] = GetParam();
  Start({"--respawn", "--set", "mapper.checkpoint_period_s=1"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  const pid_t pid = PidOf(service);
  // Counts events of the bus instead of time, so that each attempt kills the service at another point of its
  // work.
  std::mt19937 random(static_cast<unsigned>(seed));
  int events_left = std::uniform_int_distribution<int>(0, 20)(random);
  ASSERT_TRUE(Until([&] { return --events_left < 0; })) << Printed();
  kill(pid, SIGKILL);
  ExpectComplete();
}

INSTANTIATE_TEST_SUITE_P(Services, KillSweep,
                         testing::Combine(testing::Values("explorer", "mapper", "controller"),
                                          testing::Range(0, 15)),
                         [](const auto& parameter) {
                           return std::string(std::get<0>(parameter.param)) + "_" +
                                  std::to_string(std::get<1>(parameter.param));
                         });

}  // namespace
}  // namespace thalweg::test
