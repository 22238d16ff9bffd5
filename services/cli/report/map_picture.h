#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/canvas.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// What each column of voxels shows from above.
enum class ColumnKind : std::uint8_t { kUnknown, kSurface, kHollow, kWall };

/// A map seen from above, without its ceiling: in each column the highest free voxel is sought first, and
/// then the first occupied one below it. So a table shows its top, a floor itself, and a wall, which has
/// nothing free, its solid.
struct MapFromAbove {
  double voxel_size = 0.0;
  int min_x = 0;  ///< Of the voxels; picture row 0 is the largest y.
  int min_y = 0;
  cv::Mat_<std::uint8_t> kind;  ///< ColumnKind; kHollow: free with no surface known below.
  cv::Mat_<float> height;       ///< [m] top of the surface in W; 0 where there is none.
  double lowest = 0.0;          ///< [m] of the surfaces; robust against single voxels.
  double highest = 0.0;         ///< [m]
};

/// Columns that hold anything known; empty matrices without any.
MapFromAbove LookFromAbove(const OccupancyGrid& grid);

/// The map in colors by height, the path in colors by time, start and end, scale bar and keys.
void DrawMap(Canvas& canvas, const Area& area, const MapFromAbove& map,
             const std::vector<TimedPose>& trajectory);

}  // namespace thalweg::cli
