#include "services/explorer/core/outcome.h"

#include <algorithm>
#include <array>

#include "common/base/check.h"

namespace thalweg::explorer {
namespace {

constexpr std::array kPauseReasons = {
    PauseReason::kOperator,   PauseReason::kStepDone,         PauseReason::kStepInterrupted,
    PauseReason::kErrandDone, PauseReason::kErrandImpossible, PauseReason::kEnded,
    PauseReason::kRestarted,
};

/// The one of these enumerators that has the name.
template <class Enumerators>
auto FindNamed(const Enumerators& all, std::string_view name) {
  const auto found = std::ranges::find_if(all, [&](auto one) { return NameOf(one) == name; });
  return found == std::end(all) ? std::nullopt : std::optional(*found);
}

}  // namespace

Outcome OutcomeOf(Budget spent) {
  return spent == Budget::kTime ? Outcome::kTimeBudget : Outcome::kDistanceBudget;
}

bool IsBudget(Outcome outcome) {
  return outcome == Outcome::kTimeBudget || outcome == Outcome::kDistanceBudget;
}

bool IsUnsafe(Interruption interruption) {
  return interruption == Interruption::kPathBlocked || interruption == Interruption::kNotFacingPassage;
}

Interruption HomeIsDue(Budget budget) {
  return budget == Budget::kTime ? Interruption::kTimeForHome : Interruption::kDistanceForHome;
}

std::string_view NameOf(Outcome outcome) {
  switch (outcome) {
    case Outcome::kComplete:
      return "complete";
    case Outcome::kTooMuchUnknown:
      return "too_much_unknown";
    case Outcome::kNothingReachable:
      return "nothing_reachable";
    case Outcome::kNoFreeSpace:
      return "no_free_space";
    case Outcome::kTimeBudget:
      return "time_budget";
    case Outcome::kDistanceBudget:
      return "distance_budget";
    case Outcome::kNoPathHome:
      return "no_path_home";
    case Outcome::kOperator:
      return "operator";
    case Outcome::kDoesNotApply:
      return "strategy_does_not_apply";
    case Outcome::kCannotGoOn:
      return "strategy_cannot_go_on";
  }
  THALWEG_CHECK(false);
  return {};
}

std::optional<Outcome> OutcomeNamed(std::string_view name) {
  return FindNamed(kOutcomes, name);
}

std::string_view NameOf(PauseReason reason) {
  switch (reason) {
    case PauseReason::kOperator:
      return "operator";
    case PauseReason::kStepDone:
      return "step_done";
    case PauseReason::kStepInterrupted:
      return "step_interrupted";
    case PauseReason::kErrandDone:
      return "errand_done";
    case PauseReason::kErrandImpossible:
      return "errand_impossible";
    case PauseReason::kEnded:
      return "ended";
    case PauseReason::kRestarted:
      return "restarted";
  }
  THALWEG_CHECK(false);
  return {};
}

std::optional<PauseReason> PauseReasonNamed(std::string_view name) {
  return FindNamed(kPauseReasons, name);
}

}  // namespace thalweg::explorer
