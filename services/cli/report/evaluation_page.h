#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "services/cli/report/map_picture.h"
#include "services/evaluator/core/outcome.h"

namespace thalweg::cli {

/// Coverage of the runs of one strategy along distance or time, at equally spaced points from 0 to the
/// longest run. A run that has ended keeps its last coverage.
struct CoverageCurve {
  std::vector<double> at;    ///< [m] or [s]
  std::vector<double> mean;  ///< Mean over the runs.
  std::vector<double> low;   ///< First quartile of the runs.
  std::vector<double> high;  ///< Third quartile.
};
CoverageCurve CurveOver(std::span<const evaluator::Outcome* const> runs,
                        double evaluator::Outcome::Progress::*along);

/// A true world seen from above.
struct WorldPicture {
  std::vector<std::uint8_t> png;
  double min_x = 0.0;  ///< [m] In W, of its left edge.
  double min_y = 0.0;  ///< [m] Height of its lower edge.
  double width = 0.0;  ///< [m]
  double height = 0.0;
  double lowest = 0.0;  ///< [m] Heights of the lowest and the highest surface, in W.
  double highest = 0.0;
};
WorldPicture PictureOf(const MapFromAbove& map);

/// What the page draws: curves, starts and paths of each scenario. Paths are thinned to 400 points.
/// @param worlds  By scenario.
nlohmann::ordered_json EvaluationData(std::span<const evaluator::Outcome> outcomes,
                                      const std::map<std::string, WorldPicture>& worlds);

/// The evaluation as a page: one file without references to others. The verdict comes first, definitions
/// last.
/// @param overrides  Fields that were set for all runs, FIELD=VALUE.
std::string EvaluationHtml(std::span<const evaluator::Outcome> outcomes,
                           const std::map<std::string, WorldPicture>& worlds,
                           std::span<const std::string> overrides = {});

}  // namespace thalweg::cli
