#pragma once

#include "services/visual_odometry/core/trajectory_error.h"
#include "tests/services/visual_odometry/support/rendered_sequence.h"

namespace thalweg::visual_odometry::test {

/// How the odometry performed along a flight.
struct Outcome {
  TrajectoryError error;
  double inside_position = 0.0;  ///< Share of frames whose error, relative to the keyframe
  double inside_rotation = 0.0;  ///< used, lies within the 95 % ellipsoid.
  int not_tracking = 0;
  int frames = 0;
  /// Largest position error, relative to the path length, before the first frame without tracking.
  double worst_while_tracking = 0.0;
};

/// @param contrast  Below 1 the images fade toward gray, while the noise stays.
Outcome Follow(const simulator::World& world, const Flight& flight, double contrast = 1.0);

/// Prints the results.
void Print(const Outcome& outcome);

}  // namespace thalweg::visual_odometry::test
