#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "common/base/result.h"
#include "services/evaluator/core/outcome.h"

namespace thalweg::evaluator {

/// All of an outcome, to the last bit.
nlohmann::ordered_json ToJson(const Outcome& outcome);
/// Error: what is missing, or of another type.
Result<Outcome> OutcomeFromJson(const nlohmann::json& json);

/// One row per scenario and strategy, in the order in which they first come: means and deviations, for tables
/// and other programs.
nlohmann::ordered_json RowsOf(std::span<const Outcome> outcomes);

/// Each strategy against the first: a row per scenario, and one for all together, whose scenario is "all".
nlohmann::ordered_json ComparisonsOf(std::span<const Outcome> outcomes);

}  // namespace thalweg::evaluator
