#pragma once

namespace thalweg {

/// The map as the mapper makes it, the explorer plans in it and the truth is compared with it.
struct MapModel {
  double voxel_size = 0.10;  ///< [m]
  double max_range = 5.0;    ///< [m] Nothing further from the sensor is mapped.
};

}  // namespace thalweg
