#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// The poses until the end of the exploration; after that the robot rests while the processes end.
std::vector<TimedPose> PathUntilEnd(const RunRecord& record);

/// Number of frontiers left, and of those set aside, by reason.
std::string FrontiersInWords(const RunRecord& record);

/// The report for people on one page: figures, the map from above with the path, and curves of what was seen
/// over distance and over time.
/// @param map  Null if there is none.
cv::Mat DrawReport(const RunRecord& record, const OccupancyGrid* map);

}  // namespace thalweg::cli
