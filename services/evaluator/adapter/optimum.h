#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/evaluator/core/outcome.h"

namespace thalweg::evaluator {

struct OptimumOptions {
  std::vector<std::string> scenarios;  ///< Names or files; those of the outcomes.
  std::vector<std::string> overrides;  ///< Apply to all scenarios.
  /// The clearance is replaced by the scenario's: the robot's radius and its safety margin.
  TourGround::Options tours;
  /// Tours that were found are appended here, and taken from here where world, start, robot, sensor, voxels
  /// and options are the same. Tours whose budget ran out are searched for again with a larger one.
  /// Empty = none.
  std::filesystem::path cache;
  int threads = 0;  ///< 0 = one per core.
};

/// Adds the offline tours from their starts to outcomes. When stopped, those not yet found stay away.
/// @param on_tours  Called for each start, one call at a time, with the first of its outcomes, and whether
/// its tours came from the cache.
/// Throws as Scene does, and std::runtime_error when the cache cannot be written.
void AddOptimum(const OptimumOptions& options, std::vector<Outcome>& outcomes, const std::stop_token& stop,
                const std::function<void(const Outcome&, bool from_cache)>& on_tours = {});

}  // namespace thalweg::evaluator
