#pragma once

namespace thalweg {

/// The map that the mapper builds, the explorer plans in and the ground truth is compared with.
struct MapModel {
  double voxel_size = 0.10;  ///< [m]
  double max_range = 5.0;    ///< [m] Nothing farther from the sensor is mapped.
};

}  // namespace thalweg
