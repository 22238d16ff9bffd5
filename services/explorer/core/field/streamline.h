#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/explorer/core/field/harmonic_field.h"

namespace thalweg::explorer {

struct StreamlineOptions {
  double step_cells = 0.25;
  double max_length_cells = 20000.0;
};

/// How a trace ended.
enum class StreamlineEnd : std::uint8_t {
  kArrived,  ///< In a sink, weak or not (downward), or in the source (upward).
  kStuck,    ///< The gradient vanished, or no step stayed inside free space.
  kTooLong,
};

struct Streamline {
  std::vector<Eigen::Vector3d> points_W;  ///< [m] From the start; every segment lies within free space.
  StreamlineEnd end = StreamlineEnd::kStuck;
};

/// Follows the field's steepest descent from the robot to a frontier or, upward, its steepest ascent from a
/// frontier back to the robot (points then in that order). Uses fourth-order Runge-Kutta over the trilinearly
/// interpolated gradient. Walls mirror the value beside them, so that no flux crosses them. A step that would
/// leave free space is shortened and slid along the wall; where that fails, the trace moves on to the
/// neighboring cell with the least (upward: greatest) phi, so that every harmonic field is followed to its
/// end.
Streamline TraceStreamline(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& phi, double cell_size,
                           const Eigen::Vector3d& start_W, bool upward, const StreamlineOptions& options);

}  // namespace thalweg::explorer
