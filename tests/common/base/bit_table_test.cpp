#include "common/base/bit_table.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace thalweg {
namespace {

TEST(BitTable, HoldsWhatASetOfNumbersHolds) {
  constexpr std::size_t kRows = 5;
  constexpr std::size_t kColumns = 130;  // two whole words and a part
  BitTable table(kRows, kColumns);
  std::vector<std::set<std::size_t>> expected(kRows);
  std::mt19937 random(1);
  for (int n = 0; n < 2000; ++n) {
    const std::size_t row = random() % kRows;
    const std::size_t column = random() % kColumns;
    if (random() % 3 == 0) {
      table.Clear(row, column);
      expected[row].erase(column);
    } else {
      table.Set(row, column);
      expected[row].insert(column);
    }
  }
  table.AppendRow({0, 64, 129});
  expected.push_back({0, 64, 129});
  ASSERT_EQ(table.rows(), kRows + 1);
  EXPECT_EQ(table.columns(), kColumns);
  Bits known(table.words(), 0);
  std::set<std::size_t> known_expected;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    for (std::size_t column = 0; column < kColumns; ++column)
      ASSERT_EQ(table.Get(row, column), expected[row].contains(column)) << row << ", " << column;
    std::vector<std::size_t> added;
    std::vector<std::size_t> added_expected;
    ForEachNew(known, table.Of(row), [&](std::size_t column) { added.push_back(column); });
    for (const std::size_t column : expected[row]) {
      if (known_expected.insert(column).second) added_expected.push_back(column);
    }
    EXPECT_EQ(added, added_expected);
    EXPECT_EQ(CountNew(known, table.Of(row)), added_expected.size());
    Unite(known, table.Of(row));
  }
}

}  // namespace
}  // namespace thalweg
