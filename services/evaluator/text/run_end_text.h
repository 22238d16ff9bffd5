#pragma once

#include <string>

#include "services/evaluator/core/run_end.h"

namespace thalweg::evaluator {

/// Formats an end as "complete", "home within the time budget", "cut off", "interrupted", "lost", ...
std::string ToText(const RunEnd& end);

}  // namespace thalweg::evaluator
