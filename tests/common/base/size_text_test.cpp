#include "common/base/size_text.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace thalweg {
namespace {

TEST(SizeText, NamesTheWidthFirst) {
  EXPECT_EQ(SizeText(640, 480), "640 x 480");
}

TEST(SizeText, OfAnySizeThatAMessageClaims) {
  EXPECT_EQ(SizeText(std::uint64_t{1} << 40U, std::uint64_t{0}), "1099511627776 x 0");
  EXPECT_EQ(SizeText(-1, 3), "-1 x 3");
}

}  // namespace
}  // namespace thalweg
