#pragma once

#include <optional>
#include <string_view>

#include "services/explorer/core/outcome.h"

namespace thalweg::evaluator {

/// How a run in lock step ended.
struct RunEnd {
  enum class Kind : std::uint8_t {
    kExplorer,     ///< The explorer ended it, see `ending`.
    kCutOff,       ///< It reached the longest duration allowed.
    kInterrupted,  ///< The caller stopped it.
    kLost,         ///< The odometry lost the robot's pose and did not recover.
    kFlown,        ///< A given trajectory was flown to its end.
  };
  Kind kind = Kind::kExplorer;
  explorer::Ending ending = {};

  bool complete() const { return kind == Kind::kExplorer && ending.outcome == explorer::Outcome::kComplete; }
};

/// The name under which files keep its kind or the explorer's outcome, which no rewording changes:
/// "complete", "time_budget", "cut_off", ... Whether the robot was home within its budget is not part of it.
std::string_view NameOf(const RunEnd& end);
std::optional<RunEnd> RunEndNamed(std::string_view name);

}  // namespace thalweg::evaluator
