#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/voxel/dense_grid.h"

namespace thalweg::explorer {

/// What a cell is to the field.
enum class FieldCell : std::uint8_t {
  kWall,      ///< Not part of the field: zero flux through its faces. So is everything outside the grid.
  kFree,      ///< phi is solved for.
  kSource,    ///< phi = +1: the robot.
  kSink,      ///< phi = -1: a frontier.
  kWeakSink,  ///< phi = -Options::weak_sink: what is worth less than a frontier.
};
inline bool IsSink(FieldCell cell) {
  return cell == FieldCell::kSink || cell == FieldCell::kWeakSink;
}

struct FieldStatistics {
  std::size_t unknowns = 0;
  int iterations = 0;
  double relative_residual = 0.0;  ///< |b - A phi| / |b|, reached.
  double setup_ms = 0.0;
  double solve_ms = 0.0;
  double bytes_swept =
      0.0;  ///< By the sweeps, had no cache kept anything; for comparison with the bandwidth.
};

/// The harmonic potential over free space, whose steepest descent leads from the robot to frontiers without
/// local minima [Shade, Newman: Choosing where to go, ICRA 2011]:
///   sum over the six neighbours j of i that are no wall: (phi_j - phi_i) = k^2 phi_i   for free i,
/// with phi = +1 in sources, -1 in sinks and something between 0 and -1 in weak sinks, and k = cell /
/// screening length (0: Laplace's equation). A weak sink beside which phi would be lower than its own gives
/// instead of taking.
/// Free cells that no path joins to a source or a sink have phi = 0 and are no unknowns.
///
/// Solved by conjugate gradients, preconditioned with one multigrid cycle, matrix-free.
/// Threading: one thread owns a solver; it may use more.
class HarmonicField {
 public:
  struct Options {
    double relative_residual = 1e-6;
    int max_iterations = 100;
    double screening_length_cells = 0.0;  ///< 0 = none
    double weak_sink = 0.5;               ///< In (0, 1].
    int threads = 1;
  };

  HarmonicField();
  ~HarmonicField();

  /// Solves from scratch, except that `warm` (a former solution of any box, may be empty) is the first guess.
  /// @return phi for every cell; NaN in walls.
  const DenseGrid<float>& Solve(const DenseGrid<FieldCell>& cells, const Options& options,
                                const DenseGrid<float>& warm = {});

  const DenseGrid<float>& phi() const;
  /// Of the last solve, the smallest box that holds all cells that are no walls.
  const VoxelBox& open_box() const;
  const FieldStatistics& statistics() const;

  /// Flux into each group of sink cells: sum over their faces to free or source cells of (phi_j - phi_sink).
  /// @param group  Of each sink cell, weak or not, 0 to count - 1; anything else is ignored.
  static std::vector<double> InflowOf(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& phi,
                                      const DenseGrid<std::int32_t>& group, std::size_t count);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thalweg::explorer
