#pragma once

#include <cstddef>
#include <cstdint>

#include "common/voxel/dense_grid.h"
#include "services/explorer/core/field/harmonic_field.h"

namespace thalweg::explorer {

struct RelaxationOptions {
  /// What a cell's new value is computed from.
  enum class Sweep : std::uint8_t {
    kGaussSeidel,  ///< The newest values of its neighbors; cells are swept in the order of the grid.
    kJacobi,       ///< Their values of the last sweep.
  };
  /// What stands for a neighbor that is a wall.
  enum class Walls : std::uint8_t {
    /// The neighbor opposite to it, so that the slope across the wall is zero at the cell's center
    /// [Eq. 6.28].
    /// An axis with walls on both sides, which is not treated there, drops out of the mean.
    kMirrored,
    kDropped,  ///< Nothing: the mean is over the others, as in HarmonicField.
  };
  /// What a change is small beside.
  enum class Beside : std::uint8_t {
    kOldValue,      ///< The cell's own value before, as printed. Where phi passes through 0, hardly any is.
    kLargestValue,  ///< The largest magnitude of phi, which is 1.
  };
  Sweep sweep = Sweep::kGaussSeidel;
  Walls walls = Walls::kMirrored;
  Beside beside = Beside::kOldValue;
  /// It stops after the first sweep in which |change / what it is beside| is below this everywhere.
  double largest_change = 1e-4;
  int max_sweeps = 1'000'000;
};

struct Relaxation {
  DenseGrid<double> phi;  ///< NaN in walls.
  int sweeps = 0;
  bool stopped = false;  ///< By largest_change, not by max_sweeps.
};

/// The potential as the source thesis solves it [Shade: Choosing Where To Go, DPhil thesis, Oxford 2011, Ch.
/// 6]: phi is 0 in all free cells at first, +1 in sources and -1 in sinks; sweeps set each free cell to the
/// mean of its six neighbors [Eq. 6.28]. What the sweeps have not reached when they stop keeps a phi near 0.
/// Weak sinks count as sinks. Beside its old value, a cell that was 0 and changed counts as changed
/// without bound. HarmonicField
/// solves the same equation, up to the treatment of walls, to a stated residual.
Relaxation Relax(const DenseGrid<FieldCell>& cells, const RelaxationOptions& options);

}  // namespace thalweg::explorer
