#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thalweg {

/// A set of small numbers: bit n % 64 of word n / 64.
using Bits = std::vector<std::uint64_t>;

/// For each row, a set of columns, stored in whole words: which items each of some places shows, for example.
class BitTable {
 public:
  BitTable(std::size_t rows, std::size_t columns)
      : rows_(rows), columns_(columns), words_((columns + 63) / 64), bits_(rows * words_, 0) {}

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  std::size_t words() const { return words_; }  ///< In a row.
  const std::uint64_t* Of(std::size_t row) const { return bits_.data() + row * words_; }
  bool Get(std::size_t row, std::size_t column) const {
    return (Of(row)[column / 64] >> column % 64 & 1U) != 0;
  }
  void Set(std::size_t row, std::size_t column) { Word(row, column) |= std::uint64_t{1} << column % 64; }
  void Clear(std::size_t row, std::size_t column) { Word(row, column) &= ~(std::uint64_t{1} << column % 64); }
  void AppendRow(const std::vector<std::size_t>& columns) {
    bits_.resize(bits_.size() + words_, 0);
    for (const std::size_t column : columns) Set(rows_, column);
    ++rows_;
  }

 private:
  std::uint64_t& Word(std::size_t row, std::size_t column) { return bits_[row * words_ + column / 64]; }

  std::size_t rows_;
  std::size_t columns_;
  std::size_t words_;
  Bits bits_;
};

// The functions below take a set and a row with as many words.

inline void Unite(Bits& bits, const std::uint64_t* more) {
  for (std::size_t w = 0; w < bits.size(); ++w) bits[w] |= more[w];
}

/// The number of columns in the row that the set lacks.
inline std::size_t CountNew(const Bits& bits, const std::uint64_t* more) {
  std::size_t count = 0;
  for (std::size_t w = 0; w < bits.size(); ++w)
    count += static_cast<std::size_t>(std::popcount(more[w] & ~bits[w]));
  return count;
}

/// Calls visit(column) for each of them, in rising order.
template <class Visit>
void ForEachNew(const Bits& bits, const std::uint64_t* more, Visit&& visit) {
  for (std::size_t w = 0; w < bits.size(); ++w) {
    for (std::uint64_t left = more[w] & ~bits[w]; left != 0; left &= left - 1)
      visit(64 * w + static_cast<std::size_t>(std::countr_zero(left)));
  }
}

}  // namespace thalweg
