#pragma once

#include "services/explorer/core/field/device/bricks.h"

/// The relaxation of the source thesis on a device [Shade: Choosing Where To Go, DPhil thesis, Oxford 2011,
/// 6.6.1], as a baseline: Jacobi sweeps over the dense grid by blocks of 32 x 4 threads whose edges overlap,
/// with three horizontal slices in shared memory. What a cell becomes is written once, as everywhere here.
namespace thalweg::explorer::field::device {

/// Threads of a block along x and y; those at the edges only load.
constexpr int kTileX = 32;
constexpr int kTileY = 4;

/// The new value of a free cell: the mean of its six neighbors, a wall mirrored [Eq. 6.28]; an axis with
/// walls on both sides drops out, as in Relax on the CPU.
/// @param code_at, phi_at  Code and value of a neighbor, by axis and -1 or 1.
template <class CodeAt, class PhiAt>
THALWEG_PORTABLE float JacobiMean(const CodeAt& code_at, const PhiAt& phi_at, float own) {
  float sum = 0.0F;
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool up = code_at(axis, 1) != kWallCell;
    const bool down = code_at(axis, -1) != kWallCell;
    if (!up && !down) continue;
    sum += phi_at(axis, up ? 1 : -1) + phi_at(axis, down ? -1 : 1);
    count += 2;
  }
  return count > 0 ? sum / static_cast<float>(count) : own;
}

/// Whether a value counts as changed by the printed stop, |change / old value|.
THALWEG_PORTABLE bool JacobiChanged(float before, float after, float largest_change) {
  const float change = after > before ? after - before : before - after;
  return change > 0.0F && change >= largest_change * (before > 0.0F ? before : -before);
}

/// phi at the start: given values, 0 in free cells, `nothing` in walls.
struct StartJacobi {
  const std::uint8_t* codes;
  float nothing;
  float *phi, *phi_next;

  THALWEG_PORTABLE void operator()(Index i) const {
    const std::uint8_t code = codes[i];
    const float value = code == kWallCell     ? nothing
                        : code == kFreeCell   ? 0.0F
                        : code == kSourceCell ? 1.0F
                                              : -1.0F;
    phi[i] = phi_next[i] = value;
  }
};

/// What a sweep reads and writes.
struct JacobiSweep {
  GridShape shape;
  const std::uint8_t* codes;
  const float* from;
  float* to;
  float largest_change;
  Index* changed;  ///< Becomes 1 if any cell has changed.
};

}  // namespace thalweg::explorer::field::device
