#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "services/evaluator/core/summary.h"

namespace thalweg::cli {

/// Mean coverage of each strategy's runs over the distance traveled, and over time.
cv::Mat DrawCoverageCurves(std::span<const evaluator::Outcome> outcomes, const std::string& scenario);

/// The path of each strategy from one start, over the true map seen from above.
/// @param run  Index of the start.
cv::Mat DrawPaths(std::span<const evaluator::Outcome> outcomes, const std::string& scenario, int run,
                  const OccupancyGrid& truth);

/// For a terminal: one line per scenario and strategy, then each strategy compared with the first,
/// and at the end the verdict.
/// @param overrides  Fields that were set for all runs, FIELD=VALUE; a line above the table names them.
std::string EvaluationText(std::span<const evaluator::Outcome> outcomes,
                           std::span<const std::string> overrides = {});

}  // namespace thalweg::cli
