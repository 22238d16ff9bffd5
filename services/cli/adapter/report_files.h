#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/coverage_tally.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Writes report.json, trajectory.tum, report.png and report.html, each even if another one cannot be
/// written. report.html is left out, and the log says so, if its template was not built.
/// @param map            May be null.
/// @param tally          When the map's voxels became known.
/// @param page_template  File.
/// @return  For each file that was not written its name and the reason.
[[nodiscard]] std::vector<std::string> WriteReport(const RunRecord& record, const OccupancyGrid* map,
                                                   const CoverageTally& tally,
                                                   const std::filesystem::path& folder,
                                                   const std::filesystem::path& page_template);

/// "files in FOLDER: report.html, ... and logs": those of a run that are there.
std::string FilesText(const std::filesystem::path& folder);

/// The template of report.html, share/thalweg/report.html beside the bin folder of the program. It is there
/// only if Node.js was when the program was built.
std::filesystem::path RunPageTemplate();

}  // namespace thalweg::cli
