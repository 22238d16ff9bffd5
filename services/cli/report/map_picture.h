#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "common/drawing/canvas.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// What a column of voxels shows from above.
enum class ColumnKind : std::uint8_t { kUnknown, kSurface, kHollow, kWall };

/// Edge of the largest square with as many pixels as MapFromAbove may have. More than a report has room for.
inline constexpr int kMostEdge = 2000;

/// A map seen from above without its ceiling: in each column, the surface is the first occupied voxel below
/// the highest free one. A table thus shows its top, a floor itself, and a wall, which has no free voxel, is
/// solid.
struct MapFromAbove {
  double voxel_size = 0.0;
  int voxels_per_pixel = 1;  ///< Edge of a pixel; above 1 it shows its solid or else its highest column.
  int min_x = 0;             ///< Voxel index of the picture's left edge.
  int min_y = 0;             ///< Its lower edge.
  cv::Mat_<std::uint8_t>
      kind;                ///< ColumnKind; kHollow: free without a known surface below. Row 0 is the top.
  cv::Mat_<float> height;  ///< [m] Top of the surface in W; 0 if there is none.
  double lowest = 0.0;     ///< [m] Lowest surface; robust against single voxels.
  double highest = 0.0;    ///< [m] Highest surface, likewise.

  std::size_t columns = 0;           ///< Columns with known voxels.
  std::size_t columns_left_out = 0;  ///< Those of them that lie outside the picture.
  double left_out_beyond = 0.0;      ///< [m] Greatest distance along x or y from the picture to one of them.
};

/// Looks at all columns that contain known voxels; empty matrices if there are none. Parts that are not
/// connected with the part in which the path lies (without a path: the largest part), as stray voxels are,
/// are left out where they would make the picture larger than `kMostEdge` columns. If that part alone is
/// larger, a pixel shows several columns. Memory: kMostEdge^2 * 5 B and 16 B per block of the grid, whatever
/// the extent of the map.
MapFromAbove LookFromAbove(const OccupancyGrid& grid, const std::vector<TimedPose>& path = {});

/// "2 of 4872 known columns are not drawn: they lie up to 3277 m outside"; empty if all are drawn.
std::string LeftOutText(const MapFromAbove& map);

/// The map alone, a pixel for a pixel, colored by height; what is unknown is transparent. 8 bit, blue, green,
/// red, opacity.
cv::Mat PixelsOf(const MapFromAbove& map);

/// What PixelsOf means by its colors, for a legend: "#f3f0e8".
struct MapColors {
  std::vector<std::string> heights;  ///< From the lowest surface to the highest, at equal steps.
  std::string wall;                  ///< A column without a free voxel.
  std::string hollow;                ///< Free, without a known surface below.
};
MapColors ColorsOfMap();

/// Draws the map colored by height, the path colored by time, start and end, a scale bar, keys, and what was
/// left out. Poses outside the picture are not drawn.
void DrawMap(Canvas& canvas, const Area& area, const MapFromAbove& map,
             const std::vector<TimedPose>& trajectory);

}  // namespace thalweg::cli
