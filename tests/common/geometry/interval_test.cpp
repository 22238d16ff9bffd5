#include "common/geometry/interval.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(DistanceToInterval, IsThatOfTheNearerEndAndNothingWithin) {
  for (const double x : {-2.0, -1.0, 0.5}) EXPECT_EQ(DistanceToInterval(x, -2.0, 0.5), 0.0) << x;
  EXPECT_EQ(DistanceToInterval(-2.25, -2.0, 0.5), 0.25);
  EXPECT_EQ(DistanceToInterval(2.5, -2.0, 0.5), 2.0);
  EXPECT_EQ(DistanceToInterval(2.5, 1.0, 1.0), 1.5) << "an interval may be a single number";
}

}  // namespace
}  // namespace thalweg
