#include "services/cli/process/domain_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <optional>
#include <stdexcept>

namespace thalweg::cli {
namespace {

const std::string kPartition = "claim-test-" + std::to_string(getpid());

TEST(DomainClaim, IsHeldByOneRunAtATime) {
  std::optional<DomainClaim> first;
  first.emplace(7, kPartition);
  try {
    const DomainClaim second(7, kPartition);
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("another run is going on in DDS domain 7: "));
  }
  first.reset();
  EXPECT_NO_THROW(DomainClaim(7, kPartition));
}

TEST(DomainClaim, LeavesOtherDomainsAndPartitionsFree) {
  const DomainClaim first(7, kPartition);
  EXPECT_NO_THROW(DomainClaim(8, kPartition));
  EXPECT_NO_THROW(DomainClaim(7, kPartition + "x"));
  EXPECT_NO_THROW(DomainClaim(7, std::string(500, 'x') + kPartition));
}

TEST(DomainClaim, EndsWithItsProcessHoweverThatEnds) {
  std::array<int, 2> ready{};
  ASSERT_EQ(pipe(ready.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    const DomainClaim claim(9, kPartition);
    [[maybe_unused]] const auto written = write(ready[1], "x", 1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THROW(DomainClaim(9, kPartition), std::runtime_error);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(DomainClaim(9, kPartition));
  close(ready[0]);
  close(ready[1]);
}

}  // namespace
}  // namespace thalweg::cli
