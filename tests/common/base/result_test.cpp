#include "common/base/result.h"

#include <gtest/gtest.h>

#include <memory>

#include "common/base/check.h"
#include "common/base/time.h"

namespace thalweg {
namespace {

TEST(Result, HoldsAValueOrTheReasonWhyThereIsNone) {
  const Result<int> value = 7;
  ASSERT_TRUE(value);
  EXPECT_EQ(*value, 7);
  const Result<int> none = Error{"depth is 0 x 0"};
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "depth is 0 x 0");
}

TEST(Result, GivesUpAValueThatCannotBeCopied) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(3);
  const std::unique_ptr<int> taken = *std::move(result);
  EXPECT_EQ(*taken, 3);
}

TEST(CheckDeathTest, NamesTheConditionAndThePlace) {
  const int answer = 41;
  EXPECT_DEATH(THALWEG_CHECK(answer == 42), "result_test.cpp:[0-9]+: check failed: answer == 42");
}

TEST(Time, SecondsAndDurationsAreInverse) {
  EXPECT_EQ(FromSeconds(0.25), std::chrono::milliseconds(250));
  EXPECT_EQ(Seconds(std::chrono::milliseconds(1500)), 1.5);
}

}  // namespace
}  // namespace thalweg
