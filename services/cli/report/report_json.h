#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// The report for programs; keys carry their units, what is not known is null.
nlohmann::ordered_json ToJson(const RunRecord& record);

}  // namespace thalweg::cli
