#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/coverage_tally.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// No page is larger, so that it opens anywhere and can be mailed.
inline constexpr std::size_t kMostPageBytes = 5'000'000;
/// More occupied voxels are drawn as larger ones: what a browser's graphics can take.
inline constexpr std::size_t kMostOccupiedVoxels = 2'000'000;
/// Where a template, built from services/cli/page, wants the data.
inline constexpr std::string_view kDataPlace = "@RUN_DATA@";

/// A page that shows the run: one file without references to others.
///
/// Curves are thinned to 2000 points and the path to 4000. A map that does not fit is drawn with larger
/// voxels, which the page says.
/// @param page_template  Contains kDataPlace once, within a `<script>` of type application/json.
/// @param map            May be null.
/// @param tally          When voxels became known.
/// Throws std::invalid_argument if the template has no place for the data.
std::string RunPage(std::string_view page_template, const RunRecord& record, const OccupancyGrid* map,
                    const CoverageTally& tally);

}  // namespace thalweg::cli
