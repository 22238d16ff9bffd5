#include "common/base/bytes.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(TextOf, HasEveryByteInItsPlace) {
  const std::vector<std::uint8_t> bytes = {'a', 0, 0xFF};
  EXPECT_EQ(TextOf(bytes), std::string_view("a\0\xFF", 3));
  EXPECT_EQ(TextOf({}), "");
}

}  // namespace
}  // namespace thalweg
