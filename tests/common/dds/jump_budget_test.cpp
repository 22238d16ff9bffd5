#include "common/dds/jump_budget.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

using std::chrono_literals::operator""s;

class JumpBudgetTest : public testing::Test {
 protected:
  bool Allows(std::uint8_t writer, std::int64_t first, std::chrono::seconds at) {
    return budget_.Allows({writer}, first, JumpBudget::SteadyTime{} + 1000s + at);
  }
  JumpBudget budget_;
};

TEST_F(JumpBudgetTest, AWriterThatHasSentForDaysIsHeardForEver) {
  constexpr std::int64_t kSixDays = 6LL * 86'400 * 30;
  EXPECT_TRUE(Allows(1, kSixDays, 0s));
  for (int second = 0; second < 1000; ++second) {
    EXPECT_TRUE(Allows(1, kSixDays + second * 30, std::chrono::seconds(second)));
  }
  EXPECT_TRUE(Allows(1, kSixDays - 5, 1000s)) << "an older heartbeat, late";
}

TEST_F(JumpBudgetTest, JumpsBeyondTheBudgetAreRefusedAndLeaveIt) {
  EXPECT_FALSE(Allows(1, JumpBudget::kMost + 1, 0s));
  EXPECT_FALSE(Allows(1, 1LL << 56, 0s));
  EXPECT_TRUE(Allows(2, JumpBudget::kMost, 0s));
}

TEST_F(JumpBudgetTest, ManyStrangersShareOneBudgetThatComesBackSlowly) {
  std::int64_t counted = 0;
  for (std::uint8_t writer = 0; writer < 200; ++writer) {
    if (Allows(writer, 1LL << 22, 0s)) counted += 1LL << 22;
  }
  EXPECT_EQ(counted, JumpBudget::kMost);
  EXPECT_FALSE(Allows(201, 1LL << 22, 3s));
  EXPECT_TRUE(Allows(201, 1LL << 22, 4s));
  EXPECT_TRUE(Allows(202, JumpBudget::kFree, 16s)) << "young writers pay nothing";
}

}  // namespace
}  // namespace thalweg::dds
