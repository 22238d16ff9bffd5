#include "services/inspector/core/table.h"

#include <gtest/gtest.h>

namespace thalweg::inspector {
namespace {

TEST(Table, ColumnsAreAsWideAsTheirWidestCellAndLinesEndWithoutSpaces) {
  EXPECT_EQ(TableText({{"NODE", "N"}, {"mapper", "12"}, {"x", ""}}), "NODE    N\nmapper  12\nx\n");
}

TEST(Table, RowsMayDifferInLength) {
  EXPECT_EQ(TableText({{"a"}, {"b", "c", "d"}}), "a\nb  c  d\n");
  EXPECT_EQ(TableText({}), "");
}

}  // namespace
}  // namespace thalweg::inspector
