#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Writes report.json, trajectory.tum and report.png, each even if another one cannot be written.
/// @return  For each file that was not written its name and the reason.
[[nodiscard]] std::vector<std::string> WriteReport(const RunRecord& record, const OccupancyGrid* map,
                                                   const std::filesystem::path& folder);

}  // namespace thalweg::cli
