#pragma once

#include <string>

namespace thalweg::cli {

/// Names and summaries of the strategies, a line each.
/// @param indent    Before each line.
/// @param standard  The strategy that is marked as the default; "" = none.
std::string StrategyLines(const std::string& indent, const std::string& standard);

}  // namespace thalweg::cli
