#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/evaluator/core/summary.h"

namespace thalweg::cli {

/// Results of an evaluation as rows of text.
struct Table {
  using Row = std::vector<std::string>;
  Row header;
  std::vector<Row> rows;
  std::vector<std::size_t> terminal_columns;  ///< Columns that fit on a terminal.
};

/// One row per scenario and strategy.
Table SummaryTable(std::span<const evaluator::Outcome> outcomes);
/// Where the time of the runs went, and how fast the robot moved.
Table TimeTable(std::span<const evaluator::Outcome> outcomes);
/// Each strategy compared with the first, in each scenario and over all. No rows if there is only one
/// strategy.
Table ComparisonTable(std::span<const evaluator::Outcome> outcomes);
/// Duration of planning, by stage.
Table StageTable(std::span<const evaluator::Outcome> outcomes);
/// Number of runs by reason of their end.
Table EndTable(std::span<const evaluator::Outcome> outcomes);
/// Accuracy of the robots' poses in runs with odometry; no rows if there are none.
Table OdometryTable(std::span<const evaluator::Outcome> outcomes);
/// Path lengths relative to the offline tours from the same starts; no rows if there are none.
Table OptimumTable(std::span<const evaluator::Outcome> outcomes);
/// Where the paths after 95 % coverage went; no rows if no tails were recorded.
Table TailTable(std::span<const evaluator::Outcome> outcomes);
/// How well surfaces were seen, and how good the meshes are; no rows if that was not asked for.
Table SurfaceTable(std::span<const evaluator::Outcome> outcomes);
/// How little noise of the sensor changed the maps; no rows if it has none.
Table NoiseTable(std::span<const evaluator::Outcome> outcomes);
/// Frontiers that were set aside, by reason.
Table SetAsideTable(std::span<const evaluator::Outcome> outcomes);

/// Explains columns of the summary and of the comparison, in lines.
/// @param columns  Names from the tables' headers.
std::vector<std::string> NotesOn(std::span<const std::string> columns);

/// Aligns the table for a terminal, the first two columns to the left.
std::string ToText(const Table& table);

}  // namespace thalweg::cli
