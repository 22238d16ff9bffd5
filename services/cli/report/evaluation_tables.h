#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/evaluator/core/summary.h"

namespace thalweg::cli {

/// What an evaluation found, as rows of text.
struct Table {
  using Row = std::vector<std::string>;
  Row header;
  std::vector<Row> rows;
  std::vector<std::size_t> terminal_columns;  ///< Those that a terminal has room for.
};

/// A row per scenario and strategy.
Table SummaryTable(std::span<const evaluator::Outcome> outcomes);
/// Each strategy against the first, in each scenario and over all. No rows for one strategy alone.
Table ComparisonTable(std::span<const evaluator::Outcome> outcomes);
/// Times of planning, stage by stage.
Table StageTable(std::span<const evaluator::Outcome> outcomes);
/// How many runs ended why.
Table EndTable(std::span<const evaluator::Outcome> outcomes);
/// How well the robots knew their poses, of runs with odometry; no rows when there are none.
Table OdometryTable(std::span<const evaluator::Outcome> outcomes);
/// Frontiers that were set aside, and why.
Table SetAsideTable(std::span<const evaluator::Outcome> outcomes);

/// What columns of the summary and of the comparison mean, in lines.
/// @param columns  Names from the tables' headers.
std::vector<std::string> NotesOn(std::span<const std::string> columns);

/// Aligned, for a terminal; the first two columns to the left.
std::string ToText(const Table& table);

}  // namespace thalweg::cli
