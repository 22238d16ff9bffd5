#pragma once

#include <cstdint>

/// The inner loops of the matchers, compiled for several instruction sets; the best that the machine has is
/// chosen when the program runs. All are in whole numbers: results do not depend on that choice.
///
/// Costs of one row lie as [column][d], d running fastest; a column has `stride` numbers, a multiple of
/// kLanes. Right rows are stored backwards, so that the pixels that d = 0, 1, 2... ask for follow each other.
namespace thalweg::stereo {

inline constexpr int kLanes = 32;
inline constexpr int kMaxStride = 256;
/// Numbers of a column that holds as many disparities.
constexpr int StrideFor(int disparities) {
  return (disparities + kLanes - 1) / kLanes * kLanes;
}
/// Of what can be no match.
inline constexpr std::uint16_t kNever = 65535;

/// The least cost of a left pixel, and what the checks need to know beside it.
struct Choice {
  std::uint16_t d;
  std::uint16_t cost;
  std::uint16_t second;         ///< Least of those that are no neighbours of d; kNever when there is none.
  std::uint16_t before, after;  ///< At d - 1 and d + 1; kNever beyond the range.
};

/// The least costs of the right pixels of one row. Column u stands at width - 1 - u, and `stride` more places
/// follow, which are of no pixel.
struct RightBest {
  std::uint16_t* cost;
  std::uint16_t* d;
};

/// A row of a semi-global aggregation: the paths that enter it from the row before (straight and both
/// diagonals) and the one along it. Path costs are stored less their least, so that 8 bits hold them.
struct PathRow {
  int width, stride;
  int step;                  ///< +1: columns from the left, -1: from the right.
  const std::uint8_t* cost;  ///< [column][d]
  /// Of each column and of the four paths (along, diagonal from behind, straight, diagonal from ahead): the
  /// penalty of a jump.
  const std::uint8_t* jump[4];
  std::uint8_t slope;  ///< Penalty of a step by 1.
  /// Path costs [column][d] of three paths; a column has stride + 2 kLanes numbers, the first and the last
  /// kLanes of which are the edge: at least as large as any jump. One more column on either side.
  const std::uint8_t* before[3];
  std::uint8_t* here[3];
  std::uint8_t* along;  ///< Two columns, for the path along the row.
  std::uint16_t* sum;   ///< [column][d]
  bool add;             ///< To the sum, instead of beginning it.
};

struct Kernels {
  /// sums[c][d] += min(|left[c] - right[d - c]|, cut) of the row that enters, -= that of the one that leaves
  /// (null: none).
  void (*add_differences)(const std::uint8_t* left_in, const std::uint8_t* right_in,
                          const std::uint8_t* left_out, const std::uint8_t* right_out, int columns,
                          int stride, std::uint8_t cut, std::uint16_t* sums);
  /// windows[c] = sums[c] + ... + sums[c + window - 1]
  void (*sum_windows)(const std::uint16_t* sums, int columns, int window, int stride, std::uint16_t* windows);
  /// SAD5 of each column from the window sums of the rows at -radius, 0, radius, whose columns begin at
  /// -radius.
  void (*add_supports)(const std::uint16_t* above, const std::uint16_t* here, const std::uint16_t* below,
                       int columns, int radius, int stride, std::uint16_t* scores);
  /// Of each left pixel the best of the first `candidates` costs that fall into the right image, and of each
  /// right pixel. On ties the smaller d. Writes kNever over the costs that are no candidates.
  void (*choose)(std::uint16_t* costs, int columns, int candidates, int stride, Choice* choices,
                 const RightBest& right);
  /// One bit for each of the 62 neighbours in a window of 9 x 7 (9 wide): whether it is darker than the
  /// middle. `rows` point at column 0 of the seven rows; four more columns stand on both sides, and what the
  /// last vector reads beyond.
  void (*census)(const std::uint8_t* const* rows, int columns, std::uint64_t* bits);
  /// costs[c][d] = census_weight times the differing bits, / 4, plus min(|left - right|, cut)
  void (*match_cost)(const std::uint64_t* left_census, const std::uint64_t* right_census,
                     const std::uint8_t* left, const std::uint8_t* right, int columns, int stride,
                     std::uint8_t census_weight, std::uint8_t cut, std::uint8_t* costs);
  /// For strides up to kMaxStride.
  void (*aggregate)(const PathRow& row);
};

/// The best for this machine.
const Kernels& BestKernels();
/// Those that every machine has; for tests.
const Kernels& BaselineKernels();

}  // namespace thalweg::stereo
