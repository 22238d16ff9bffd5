#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/explorer/core/map/look_memory.h"

namespace thalweg::explorer {

/// What may run out on the way.
enum class Budget : std::uint8_t { kTime, kDistance };

/// Why an exploration ended, or why the robot goes home.
enum class Outcome : std::uint8_t {
  kComplete,          ///< Nothing reachable is left to see.
  kTooMuchUnknown,    ///< Nothing is left to go to, but too much was looked at in vain to call that complete.
  kNothingReachable,  ///< The robot is shut in.
  kNoFreeSpace,       ///< After turning all around, no free space is known at the robot.
  kTimeBudget,
  kDistanceBudget,
  kNoPathHome,  ///< It had to return, and the map knows no path.
};
Outcome OutcomeOf(Budget spent);
/// Whether a budget ended it.
bool IsBudget(Outcome outcome);

/// How an exploration ended.
struct Ending {
  Outcome outcome = Outcome::kComplete;
  /// The robot has returned to where it set out because a budget was running out.
  bool home_within_budget = false;

  /// What stayed unknown although free space ends at it; filled when nothing was left to go to.
  struct Missed {
    AsideReason reason = AsideReason::kNone;  ///< kNone: too small to matter.
    double area = 0.0;                        ///< [m^2]
  };
  std::vector<Missed> missed = {};
  double missed_area = 0.0;   ///< [m^2] The sum.
  double missed_share = 0.0;  ///< Of all that free space ends at.
  std::size_t doubtful_voxels = 0;

  /// Whether the robot did what it was sent for: it saw everything, or its budget brought it back home.
  bool succeeded() const { return outcome == Outcome::kComplete || home_within_budget; }
};

/// Why a plan that is being carried out is given up for a new one.
enum class Interruption : std::uint8_t {
  kPathBlocked,        ///< The map has changed, and the path ahead is no longer clear.
  kNotFacingPassage,   ///< The robot is not turned to the narrow passage that it enters.
  kTimeForHome,        ///< What is left of the time budget is needed for the path home.
  kDistanceForHome,    ///< The same of the distance budget.
  kTargetSeen,         ///< Enough of the target was seen on the way.
  kClockReset,         ///< The clock went back.
  kLost,               ///< The robot lost its place, and has found it again.
  kControllerStopped,  ///< The controller stands before the path's end and does not go on.
  kMapReplaced,        ///< The mapper sent a whole map, which may be another one.
};
/// Whether going on would be dangerous.
bool IsUnsafe(Interruption interruption);
Interruption HomeIsDue(Budget budget);

/// "complete", "home within the time budget", "incomplete: too much stayed unknown", ...
std::string ToText(const Ending& ending);
/// The ending that has this text, if there is one.
std::optional<Ending> EndingFrom(std::string_view text);
std::string_view ToText(Outcome outcome);
std::string_view ToText(Interruption interruption);

}  // namespace thalweg::explorer
