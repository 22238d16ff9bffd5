#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/voxel/dense_grid.h"
#include "services/explorer/core/field/field_cell.h"

namespace thalweg::explorer {

struct FieldStatistics {
  std::size_t unknowns = 0;
  int iterations = 0;
  double relative_residual = 0.0;  ///< |b - A phi| / |b|, as reached.
  bool on_gpu = false;
  std::string
      gpu_failure;        ///< Why a GPU that the solver opened could not be used; the CPU has solved it then.
  double setup_ms = 0.0;  ///< 0 on a GPU, where the set-up is a part of the solve.
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
/// Solved matrix-free by conjugate gradients, preconditioned with one multigrid cycle; on a GPU if there is
/// one and the map is large (device/device_solver.h). Threading: one thread owns a solver, which may use more
/// threads.
class HarmonicField {
 public:
  enum class Solver : std::uint8_t {
    kAutomatic,  ///< A GPU from kCellsForGpu cells on, where this build and this machine have one.
    kCpu,
    kGpu,  ///< Always.
  };
  /// Cells of the grid from which on a GPU is worth it.
  static constexpr std::size_t kCellsForGpu = 300'000;

  struct Options {
    double relative_residual = 1e-6;
    int max_iterations = 100;
    double screening_length_cells = 0.0;  ///< 0 = none.
    double weak_sink = 0.5;               ///< In (0, 1].
    int threads = 1;                      ///< On the CPU; more pay from some millions of cells on.
    Solver solver = Solver::kAutomatic;
  };

  HarmonicField();
  HarmonicField(HarmonicField&&) noexcept;
  HarmonicField& operator=(HarmonicField&&) noexcept;
  ~HarmonicField();

  /// @throws std::invalid_argument  saying why, if there is no GPU that kGpu could use.
  static void RequireGpu();

  /// Solves from scratch, except that `warm`, a former solution over any box, serves as the initial guess;
  /// may be empty. A GPU does without: it would have to be copied in.
  /// @return phi for every cell; NaN in walls.
  /// @throws std::runtime_error  if Solver::kGpu is asked for and there is no GPU, or it fails.
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
