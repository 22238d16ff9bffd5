#include "common/base/zig_zag.h"

#include <gtest/gtest.h>

#include <limits>

namespace thalweg {
namespace {

TEST(ZigZag, OrdersByMagnitude) {
  std::uint64_t expected = 0;
  for (const std::int64_t value : {0, -1, 1, -2, 2, -3, 3}) EXPECT_EQ(ZigZag(value), expected++) << value;
}

TEST(ZigZag, IsInvertedUpToTheLimits) {
  using Limits = std::numeric_limits<std::int64_t>;
  for (const std::int64_t value : {Limits::min(), Limits::min() + 1, std::int64_t{-1000}, std::int64_t{0},
                                   std::int64_t{1000}, Limits::max() - 1, Limits::max()})
    EXPECT_EQ(FromZigZag(ZigZag(value)), value);
}

}  // namespace
}  // namespace thalweg
