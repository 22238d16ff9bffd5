#pragma once

#include "services/visual_odometry/core/trajectory_error.h"
#include "tests/services/visual_odometry/rendered_sequence.h"

namespace thalweg::visual_odometry::test {

/// How the odometry did along a flight.
struct Outcome {
  TrajectoryError error;
  double inside_position = 0.0;  ///< Share of frames whose error lies within the 95 % ellipsoid, against the
  double inside_rotation = 0.0;  ///< keyframe that each was measured against.
  int not_tracking = 0;
  int frames = 0;
  /// Largest error of the position, relative to the way, before the first frame that was not tracking.
  double worst_while_tracking = 0.0;
};

/// @param contrast  Below 1 the pictures fade towards grey, while the noise stays.
Outcome Follow(const simulator::World& world, const Flight& flight, double contrast = 1.0);

/// Prints the figures.
void Tell(const Outcome& outcome);

}  // namespace thalweg::visual_odometry::test
