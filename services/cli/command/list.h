#pragma once

#include <string>

namespace thalweg::cli {

/// Names and summaries of the strategies, a line each.
/// @param indent  Before each line.
std::string StrategyLines(const std::string& indent);

}  // namespace thalweg::cli
