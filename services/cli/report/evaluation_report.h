#pragma once

#include <map>
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

/// For a terminal: one line per scenario and strategy, then each strategy compared with the first.
std::string EvaluationText(std::span<const evaluator::Outcome> outcomes);

/// The same and more as a self-contained page.
/// @param pictures  Of each scenario, as PNG, in the order in which they are shown.
std::string EvaluationHtml(std::span<const evaluator::Outcome> outcomes,
                           const std::map<std::string, std::vector<std::vector<std::uint8_t>>>& pictures);

}  // namespace thalweg::cli
