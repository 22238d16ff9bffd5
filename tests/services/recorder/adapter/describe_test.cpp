#include "services/recorder/adapter/describe.h"

#include <gtest/gtest.h>

namespace thalweg::recorder {
namespace {

TEST(Describe, ASpanIsCutToMilliseconds) {
  using std::chrono::microseconds;
  EXPECT_EQ(SecondsText(microseconds(12'345'999)), "12.345 s");
  EXPECT_EQ(SecondsText(microseconds(2'300'000)), "2.300 s");
  EXPECT_EQ(SecondsText(microseconds(-1'000'000)), "-1.000 s");
  EXPECT_EQ(SecondsText(Duration(0)), "0.000 s");
}

}  // namespace
}  // namespace thalweg::recorder
