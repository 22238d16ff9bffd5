#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/evaluator/adapter/campaign.h"
#include "services/simulator/core/truth.h"

namespace thalweg::cli {

/// The true map as an occupancy grid in which everything that the map holds is known.
OccupancyGrid GridOf(const simulator::TrueMap& truth, double voxel_size);

/// Writes an evaluation's report: index.html and, for each scenario, its curves of coverage and its paths as
/// pictures. Throws std::runtime_error naming a file that cannot be written.
void WriteEvaluation(const std::vector<evaluator::Outcome>& outcomes,
                     const evaluator::Campaign::Options& campaign, const std::filesystem::path& folder);

}  // namespace thalweg::cli
