#include "services/cli/report/chart.h"

#include <gtest/gtest.h>

#include <vector>

namespace thalweg::cli {
namespace {

TEST(NiceTicks, AreRoundAndWithinTheAxis) {
  EXPECT_EQ(NiceTicks(0.0, 100.0, 5), (std::vector<double>{0, 20, 40, 60, 80, 100}));
  EXPECT_EQ(NiceTicks(0.0, 0.9, 4).size(), 2U);
  EXPECT_EQ(NiceTicks(0.0, 23.0, 6), (std::vector<double>{0, 5, 10, 15, 20}));
  EXPECT_EQ(TickText(0.25, 0.05), "0.25");
  EXPECT_EQ(TickText(20.0, 20.0), "20");
}

}  // namespace
}  // namespace thalweg::cli
