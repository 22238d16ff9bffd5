#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/voxel/dense_grid.h"

namespace thalweg::explorer {

/// The role of a cell in the field.
enum class FieldCell : std::uint8_t {
  kWall,    ///< Not part of the field: no flux through its faces. Everything outside the grid is a wall, too.
  kFree,    ///< phi is solved for.
  kSource,  ///< phi = +1: the robot.
  kSink,    ///< phi = -1: a frontier.
  kWeakSink,  ///< phi = -Options::weak_sink: a target worth less than a frontier.
};
inline bool IsSink(FieldCell cell) {
  return cell == FieldCell::kSink || cell == FieldCell::kWeakSink;
}

struct FieldStatistics {
  std::size_t unknowns = 0;
  int iterations = 0;
  double relative_residual = 0.0;  ///< |b - A phi| / |b|, as reached.
  double setup_ms = 0.0;
  double solve_ms = 0.0;
  /// Read and written by the sweeps if nothing stays in a cache; for comparison with the memory bandwidth.
  double bytes_swept = 0.0;
};

/// The harmonic potential over free space. Its steepest descent leads from the robot to frontiers without
/// local minima [Shade, Newman: Choosing where to go, ICRA 2011]:
///   sum over the six neighbors j of i that are no wall: (phi_j - phi_i) = k^2 phi_i   for free i,
/// with phi = +1 in sources, -1 in sinks and a value between 0 and -1 in weak sinks, and k = cell / screening
/// length (0: Laplace's equation). A weak sink acts as a source toward cells whose phi would be lower than
/// its own. Free cells that no path connects to a source or a sink have phi = 0 and are not unknowns.
///
/// Solved matrix-free by conjugate gradients, preconditioned with one multigrid cycle.
/// Threading: one thread owns a solver, which may use more threads.
class HarmonicField {
 public:
  struct Options {
    double relative_residual = 1e-6;
    int max_iterations = 100;
    double screening_length_cells = 0.0;  ///< 0 = none.
    double weak_sink = 0.5;               ///< In (0, 1].
    int threads = 1;
  };

  HarmonicField();
  ~HarmonicField();

  /// Solves from scratch, except that `warm`, a former solution over any box, serves as the initial guess;
  /// may be empty.
  /// @return phi for every cell; NaN in walls.
  const DenseGrid<float>& Solve(const DenseGrid<FieldCell>& cells, const Options& options,
                                const DenseGrid<float>& warm = {});

  const DenseGrid<float>& phi() const;
  /// The smallest box that contains all cells other than walls, as of the last solve.
  const VoxelBox& open_box() const;
  const FieldStatistics& statistics() const;

  /// Flux into each group of sink cells: the sum of (phi_j - phi_sink) over their faces to free or source
  /// cells.
  /// @param group  For each sink cell, weak or not, 0 to count - 1; cells with any other value are ignored.
  static std::vector<double> InflowOf(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& phi,
                                      const DenseGrid<std::int32_t>& group, std::size_t count);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thalweg::explorer
