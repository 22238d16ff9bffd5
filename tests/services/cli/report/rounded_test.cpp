#include "services/cli/report/rounded.h"

#include <gtest/gtest.h>

#include <limits>

namespace thalweg::cli {
namespace {

TEST(Rounded, KeepsFourDecimalsOfWhatIsKnownAndFinite) {
  EXPECT_EQ(Rounded(0.123449).dump(), "0.1234");
  EXPECT_EQ(Rounded(std::optional<double>(-2.00005001)).dump(), "-2.0001");
  EXPECT_TRUE(Rounded(std::optional<double>()).is_null());
  EXPECT_EQ(Rounded(std::vector<double>{1.5, std::numeric_limits<double>::infinity()}).dump(), "[1.5,null]");
}

}  // namespace
}  // namespace thalweg::cli
