#include "common/base/duration_text.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(DurationText, TakesTheUnitThatIsEasiestToGrasp) {
  EXPECT_EQ(DurationText(0.0), "0.00 s");
  EXPECT_EQ(DurationText(0.349), "0.35 s");
  EXPECT_EQ(DurationText(-40.4), "40 s");
  EXPECT_EQ(DurationText(119.0), "119 s");
  EXPECT_EQ(DurationText(720.0), "12 min");
  EXPECT_EQ(DurationText(3.0 * 3600.0), "3 h");
  EXPECT_EQ(DurationText(5.0 * 86400.0), "5 days");
  EXPECT_EQ(DurationText(1795507579.3), "57 years");
}

}  // namespace
}  // namespace thalweg
