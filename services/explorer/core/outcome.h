#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/explorer/core/map/inspected_surface.h"
#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/path/shut_in.h"

namespace thalweg::explorer {

/// What may run out during an exploration.
enum class Budget : std::uint8_t { kTime, kDistance };

/// Why an exploration ended, or why the robot goes home.
enum class Outcome : std::uint8_t {
  kComplete,  ///< Nothing reachable is left to see.
  /// Nothing is left to go to, but too much was looked at in vain to call the exploration complete.
  kTooMuchUnknown,
  kNothingReachable,  ///< The robot is shut in.
  kNoFreeSpace,       ///< After turning all around, no free space is known at the robot.
  kTimeBudget,
  kDistanceBudget,
  kNoPathHome,    ///< The robot must return, and the map knows no path.
  kOperator,      ///< An operator ended the exploration, or sent the robot home.
  kDoesNotApply,  ///< The strategy is not made for what was found, see Ending::misfit_W.
  kCannotGoOn,    ///< The strategy is stuck, see Ending::why.
};
inline constexpr Outcome kOutcomes[] = {
    Outcome::kComplete,     Outcome::kTooMuchUnknown, Outcome::kNothingReachable, Outcome::kNoFreeSpace,
    Outcome::kTimeBudget,   Outcome::kDistanceBudget, Outcome::kNoPathHome,       Outcome::kOperator,
    Outcome::kDoesNotApply, Outcome::kCannotGoOn,
};
Outcome OutcomeOf(Budget spent);
/// Whether the exploration ended because of a budget.
bool IsBudget(Outcome outcome);

/// How an exploration ended.
struct Ending {
  Outcome outcome = Outcome::kComplete;
  /// The robot has returned to its start because a budget was running out.
  bool home_within_budget = false;

  /// Unknown voxels that border on free space; filled when nothing was left to go to.
  struct Missed {
    AsideReason reason = AsideReason::kNone;
    double area = 0.0;  ///< [m^2]
  };
  std::vector<Missed> missed = {};
  double missed_area = 0.0;   ///< [m^2] Sum of the areas.
  double missed_share = 0.0;  ///< Share of the border of free space.
  /// [m^2] What could be seen, of all that is out of sight, if unknown space did not bar paths to places that
  /// see it (CandidateSearch::Hidden). Counted only where the ending depends on it.
  double hidden_area = 0.0;
  std::vector<VoxelIndex> bars = {};  ///< Where such paths first leave what the robot can reach.
  /// [m^2] What could be seen if ways were open that are shut and were not (ShutWays).
  double shut_area = 0.0;
  std::vector<Eigen::Vector3d> shut_ways_W = {};  ///< [m] Where they are.
  /// What could be seen by tight ways that the robot did not go (FindTightWays), the largest first.
  struct TightWay {
    Eigen::Vector3d place_W{0, 0, 0};  ///< [m] Where it becomes too narrow.
    double area = 0.0;                 ///< [m^2] What could be seen.
  };
  std::vector<TightWay> tight_ways = {};
  /// Frontiers that the robot could have gone to see, which the strategy found not worth the path.
  std::size_t left_frontiers = 0;
  double left_area = 0.0;  ///< [m^2] Theirs, not among the missed.
  std::size_t doubtful_voxels = 0;
  /// Surface that borders on free space [m^2], where it was to be inspected.
  std::optional<InspectedSurface::Area> surface = {};
  /// [m] For kDoesNotApply: what shows it, see Strategy::FindMisfit.
  std::optional<Eigen::Vector3d> misfit_W = {};
  /// What the strategy gives as the reason, if it is one that goes by views and has ended the exploration; as
  /// words for people.
  std::string why = {};
  std::size_t left_out = 0;  ///< Places where the strategy would have looked, had the map allowed it.
  std::optional<ShutIn> shut_in = {};  ///< For kNothingReachable, unless no-go boxes are the cause.

  /// Whether the robot fulfilled its mission: it saw everything, or returned home within its budget.
  bool succeeded() const { return outcome == Outcome::kComplete || home_within_budget; }
};

/// Why a plan being executed is abandoned for a new one.
enum class Interruption : std::uint8_t {
  kPathBlocked,        ///< The map has changed, and the path ahead is no longer clear.
  kNotFacingPassage,   ///< The robot does not face the narrow passage that it is entering.
  kTimeForHome,        ///< The rest of the time budget is needed for the path home.
  kDistanceForHome,    ///< The rest of the distance budget is needed for the path home.
  kTargetSeen,         ///< Enough of the target, or of the passage to be faced, was seen before the end.
  kClockReset,         ///< The clock jumped back.
  kLost,               ///< The robot lost its pose and has recovered.
  kControllerStopped,  ///< The controller stands before the end of the path and does not continue.
  kMapReplaced,        ///< The mapper sent a whole map, which may differ from the previous one.
  kOperator,           ///< An operator's command.
  kMapSilent,          ///< No scan has reached the map for a while, so the robot does not see where it goes.
};
/// Why the robot waits, paused.
enum class PauseReason : std::uint8_t {
  kOperator,          ///< An operator paused it.
  kStepDone,          ///< The one decision that an operator asked for has been carried out,
  kStepInterrupted,   ///< or was interrupted.
  kErrandDone,        ///< The robot has done what an operator sent it to do,
  kErrandImpossible,  ///< or no longer can.
  kEnded,             ///< An earlier process ended the exploration.
  kRestarted,         ///< An earlier process was carrying out a command.
};
struct PauseCause {
  PauseReason reason = PauseReason::kOperator;
  std::string error{};  ///< For kErrandImpossible: why there is no plan.
  bool operator==(const PauseCause&) const = default;
};
/// Whether continuing would be dangerous.
bool IsUnsafe(Interruption interruption);
Interruption HomeIsDue(Budget budget);

/// The name under which files keep it, which no rewording changes: "complete", "too_much_unknown", ...
std::string_view NameOf(Outcome outcome);
std::optional<Outcome> OutcomeNamed(std::string_view name);
/// Likewise: "operator", "step_done", ...
std::string_view NameOf(PauseReason reason);
std::optional<PauseReason> PauseReasonNamed(std::string_view name);

}  // namespace thalweg::explorer
