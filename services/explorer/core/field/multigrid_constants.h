#pragma once

#include <cmath>

/// What the solvers on the CPU and on a device have in common. C++17, since nvcc 11 knows no later one.
namespace thalweg::explorer::field {

/// Weight of the Jacobi smoother.
constexpr float kRelaxation = 0.83F;

/// The Galerkin sum over a 2x2x2 block, halved for the doubled distance, and halved again so that an open
/// face has weight 1 on every level.
constexpr float kFaceScale = 0.25F;
/// Screening acts on the volume: its sum over the eight cells is only divided by the same normalization.
constexpr float kMassScale = 0.5F;

/// The factor of the share of given values in the diagonal: cells with given values lie half a coarse cell
/// plus half a fine cell from the center of a coarse cell, not a whole coarse cell.
/// @param level  The finest is 0.
inline float SlackFactor(int level) {
  const float edge = std::ldexp(1.0F, level);
  return 2.0F * edge / (edge + 1.0F);
}

/// Levels with at most this many nodes are solved by a dense inverse.
constexpr unsigned kBottomNodes = 64;

/// A residual in single precision is trusted down to this share of its value at the last fold.
constexpr double kFold = 1e-3;

}  // namespace thalweg::explorer::field
