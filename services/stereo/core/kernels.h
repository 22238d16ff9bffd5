#pragma once

#include <cstdint>

/// The inner loops of the matchers, compiled for several instruction sets, of which the best is chosen at run
/// time. All use integer arithmetic, so that results do not depend on that choice.
///
/// Costs of a row are laid out as [column][d] with d contiguous; a column has `stride` values, a multiple of
/// kLanes. Right rows are stored in reverse, so that the pixels for d = 0, 1, 2... are contiguous.
namespace thalweg::stereo {

inline constexpr int kLanes = 32;
inline constexpr int kMaxStride = 256;
/// Number of values per column for the given number of disparities.
constexpr int StrideFor(int disparities) {
  return (disparities + kLanes - 1) / kLanes * kLanes;
}
/// Cost of a candidate that is no match.
inline constexpr std::uint16_t kNever = 65535;

/// The smallest cost of a left pixel, with what the checks need.
struct Choice {
  std::uint16_t d;
  std::uint16_t cost;
  std::uint16_t second;         ///< Smallest cost of those not adjacent to d; kNever if there is none.
  std::uint16_t before, after;  ///< Costs at d - 1 and d + 1; kNever beyond the range.
};

/// The smallest costs of the right pixels of a row. Column u is stored at width - 1 - u; `stride` more
/// elements follow that belong to no pixel.
struct RightBest {
  std::uint16_t* cost;
  std::uint16_t* d;
};

/// A row of a semi-global aggregation: three paths that enter it from the previous row (straight and both
/// diagonals) and one along it. Path costs are stored minus their minimum, so that they fit in 8 bits.
struct PathRow {
  int width, stride;
  int step;                  ///< +1: columns from the left; -1: from the right.
  const std::uint8_t* cost;  ///< [column][d]
  /// Penalty of a jump, for each column and each of the four paths (along, diagonal from behind, straight,
  /// diagonal from ahead).
  const std::uint8_t* jump[4];
  std::uint8_t slope;  ///< Penalty of a disparity step by 1.
  /// Path costs [column][d] of three paths. A column has stride + 2 kLanes values; its first and last kLanes
  /// are padding that is at least as large as any jump. There is one extra column on either side.
  const std::uint8_t* before[3];
  std::uint8_t* here[3];
  std::uint8_t* along;  ///< Two columns of path costs, for the path along the row.
  std::uint16_t* sum;   ///< [column][d]
  bool add;             ///< Whether to add to the sum rather than overwrite it.
};

struct Kernels {
  /// sums[c][d] += min(|left[c] - right[d - c]|, cut) for the row that enters, -= for the row that leaves
  /// (null: none).
  void (*add_differences)(const std::uint8_t* left_in, const std::uint8_t* right_in,
                          const std::uint8_t* left_out, const std::uint8_t* right_out, int columns,
                          int stride, std::uint8_t cut, std::uint16_t* sums);
  /// windows[c] = sums[c] + ... + sums[c + window - 1]
  void (*sum_windows)(const std::uint16_t* sums, int columns, int window, int stride, std::uint16_t* windows);
  /// Computes the SAD5 score of each column from the window sums of the rows at -radius, 0 and radius, whose
  /// columns begin at -radius.
  void (*add_supports)(const std::uint16_t* above, const std::uint16_t* here, const std::uint16_t* below,
                       int columns, int radius, int stride, std::uint16_t* scores);
  /// For each left pixel, chooses the best of the first `candidates` costs that lie in the right image, and
  /// likewise for each right pixel. On ties, the smaller d wins. Overwrites the costs that are no candidates
  /// with kNever.
  void (*choose)(std::uint16_t* costs, int columns, int candidates, int stride, Choice* choices,
                 const RightBest& right);
  /// Sets one bit for each of the 62 neighbors in a window of 9 x 7 (9 wide) that is darker than the center.
  /// `rows` point to column 0 of the seven rows; four more columns must be readable on both sides, and on the
  /// right also what the last vector reads beyond.
  void (*census)(const std::uint8_t* const* rows, int columns, std::uint64_t* bits);
  /// costs[c][d] = census_weight / 4 times the Hamming distance, plus min(|left - right|, cut)
  void (*match_cost)(const std::uint64_t* left_census, const std::uint64_t* right_census,
                     const std::uint8_t* left, const std::uint8_t* right, int columns, int stride,
                     std::uint8_t census_weight, std::uint8_t cut, std::uint8_t* costs);
  /// Supports strides up to kMaxStride.
  void (*aggregate)(const PathRow& row);
};

/// The best kernels for this machine.
const Kernels& BestKernels();
/// The kernels that run on every machine; for tests.
const Kernels& BaselineKernels();

}  // namespace thalweg::stereo
