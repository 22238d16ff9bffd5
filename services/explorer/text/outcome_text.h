#pragma once

#include <string>
#include <string_view>

#include "services/explorer/core/outcome.h"

namespace thalweg::explorer {

/// "complete", "incomplete: too much stayed unknown", "time budget", ...
std::string_view OutcomeText(Outcome outcome);
/// As for the outcome, but "home within the time budget" for a robot that has returned within it, and with
/// the reason that a strategy gives.
std::string EndingText(const Ending& ending);

/// Why voxels were set aside: "looked at and stayed unknown", ...
/// @param doubtful  Whether they are known, but uncertain. With kNone, says no more than that.
std::string AsideText(AsideReason reason, bool doubtful);

}  // namespace thalweg::explorer
