#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// The report for programs; keys include their units, unknown values are null.
nlohmann::ordered_json ToJson(const RunRecord& record);

}  // namespace thalweg::cli
