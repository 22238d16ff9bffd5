#pragma once

#include <optional>
#include <span>
#include <string>

#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// [s] On the run's clock, how long the exploration will still take; empty while nobody can know.
///
/// From their greatest number on, frontiers become fewer at a steady rate at first, and then in a slow tail:
/// a straight line through then and now ends too early, an exponential too late. The square root of their
/// number falls about evenly, and the estimate is where it reaches 0. There is none in the first 20 s after
/// the greatest number, none before a fifth of it is gone, and none while the known volume grew by more than
/// a fifth in the latter half of the run, since new space brings new frontiers.
std::optional<double> RemainingTime(std::span<const ProgressSample> progress);

/// "about 2 min", "under a minute", "about 3 h"
std::string AboutText(double seconds);

}  // namespace thalweg::cli
