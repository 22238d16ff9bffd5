#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "common/base/result.h"
#include "services/evaluator/core/outcome.h"

namespace thalweg::evaluator {

/// Converts an outcome without loss of precision.
nlohmann::ordered_json ToJson(const Outcome& outcome);
/// Converts back. The error names the field that is missing or has another type.
Result<Outcome> OutcomeFromJson(const nlohmann::json& json);

nlohmann::ordered_json ToJson(const OfflineTours& tours);
/// Converts back. The error names what is missing or has another type.
Result<OfflineTours> OfflineToursFromJson(const nlohmann::json& json);

/// One row per scenario and strategy, in order of first appearance: means and deviations, for tables and
/// other programs.
nlohmann::ordered_json RowsOf(std::span<const Outcome> outcomes);

/// Each strategy compared with the first: one row per scenario, and one over all scenarios whose scenario is
/// "all".
nlohmann::ordered_json ComparisonsOf(std::span<const Outcome> outcomes);

/// Everything about an evaluation: {"overrides", "rows", "comparisons", "runs"}.
/// @param overrides  Fields that were set for all runs, FIELD=VALUE.
nlohmann::ordered_json EvaluationJson(std::span<const Outcome> outcomes,
                                      std::span<const std::string> overrides);

}  // namespace thalweg::evaluator
