#pragma once

#include <filesystem>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Writes trajectory.tum, report.json and report.png. Throws std::runtime_error naming the file.
void WriteReport(const RunRecord& record, const OccupancyGrid* map, const std::filesystem::path& folder);

}  // namespace thalweg::cli
