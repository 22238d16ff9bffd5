#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// How many frontiers are left, and how many were given up for which reason.
std::string FrontiersInWords(const RunRecord& record);

/// The report for people, one page: figures, the map from above with the path, and the curves of what was
/// seen over distance and over time. @param map  Null when there is none.
cv::Mat DrawReport(const RunRecord& record, const OccupancyGrid* map);

}  // namespace thalweg::cli
