#pragma once

#include <cstdint>
#include <string>

#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// "complete: 12.3 m in 1:23 simulated, 0:21 wall clock; 45.6 m3 explored; ..."
/// @param simulated  Whether the run's clock is a simulator's rather than the system's.
std::string SummaryText(const RunRecord& record, bool simulated);

/// "3 clouds not mapped (missing by their stamps: lost on the way, or never sent)"
/// @param why  The last reason.
std::string CloudsNotMappedText(std::uint64_t count, const std::string& why);

}  // namespace thalweg::cli
