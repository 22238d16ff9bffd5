#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "services/evaluator/core/summary.h"

namespace thalweg::cli {

/// Mean coverage of each strategy's runs over the distance traveled, and over time.
cv::Mat DrawCoverageCurves(std::span<const evaluator::Outcome> outcomes, const std::string& scenario);

/// For each strategy the path from one start, over the true map from above. @param run  Which start.
cv::Mat DrawPaths(std::span<const evaluator::Outcome> outcomes, const std::string& scenario, int run,
                  const OccupancyGrid& truth);

/// For a terminal: one line a scenario and strategy, then each strategy against the first.
std::string EvaluationText(std::span<const evaluator::Outcome> outcomes);

/// The same and more as one page that needs nothing else.
/// @param pictures  Of each scenario, as PNG: shown in their order.
std::string EvaluationHtml(std::span<const evaluator::Outcome> outcomes,
                           const std::map<std::string, std::vector<std::vector<std::uint8_t>>>& pictures);

}  // namespace thalweg::cli
