#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// The report for programs; keys carry their units, what is not known is null.
nlohmann::ordered_json ToJson(const RunRecord& record);

/// One line a pose, "stamp tx ty tz qx qy qz qw" [s, m], as the TUM RGB-D benchmark and evo have it.
void WriteTum(const std::vector<TrajectoryPose>& trajectory, std::ostream& out);

}  // namespace thalweg::cli
