#include "common/dds/sole_writer.h"

#include <gtest/gtest.h>

#include <set>

namespace thalweg::dds {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

class SoleWriterTest : public testing::Test {
 protected:
  bool Accepts(int writer, Duration at) {
    return writer_.Accepts(writer, SoleWriter<int>::SteadyTime{} + at,
                           [&](int id) { return matched_.contains(id); });
  }

  SoleWriter<int> writer_{1s};
  std::set<int> matched_ = {1, 2};
};

TEST_F(SoleWriterTest, TheFirstIsFollowedAndASecondRefused) {
  EXPECT_FALSE(writer_.followed());
  EXPECT_TRUE(Accepts(1, 0ms));
  EXPECT_FALSE(Accepts(2, 100ms));
  EXPECT_TRUE(Accepts(1, 900ms));
  EXPECT_FALSE(Accepts(2, 1900ms)) << "silent for no more than 1 s";
  EXPECT_EQ(writer_.followed(), 1);
}

TEST_F(SoleWriterTest, AnotherTakesOverWhenTheFirstIsSilent) {
  EXPECT_TRUE(Accepts(1, 0ms));
  EXPECT_TRUE(Accepts(2, 1001ms));
  EXPECT_FALSE(Accepts(1, 1100ms)) << "it is the second now";
}

TEST_F(SoleWriterTest, AnotherTakesOverAtOnceWhenTheFirstIsGone) {
  EXPECT_TRUE(Accepts(1, 0ms));
  matched_.erase(1);
  EXPECT_TRUE(Accepts(2, 1ms));
}

}  // namespace
}  // namespace thalweg::dds
