#include "common/base/megabytes.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(Megabytes, AreMillionsOfBytes) {
  EXPECT_DOUBLE_EQ(Megabytes(2.5e6), 2.5);
  EXPECT_EQ(BytesFromMegabytes(2.5), 2'500'000U);
  EXPECT_EQ(BytesFromMegabytes(0.0), 0U);
  EXPECT_EQ(BytesFromMegabytes(1e-7), 0U) << "less than a byte";
}

TEST(MegabytesText, HasOneDecimal) {
  EXPECT_EQ(MegabytesText(0.0), "0.0 MB");
  EXPECT_EQ(MegabytesText(45'240'000.0), "45.2 MB");
  EXPECT_EQ(MegabytesText(1e12), "1000000.0 MB");
}

}  // namespace
}  // namespace thalweg
