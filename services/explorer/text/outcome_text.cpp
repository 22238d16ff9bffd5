#include "services/explorer/text/outcome_text.h"

#include "common/base/check.h"

namespace thalweg::explorer {
namespace {

/// Why something was set aside.
std::string_view ReasonText(AsideReason reason) {
  switch (reason) {
    case AsideReason::kLookedAt:
      return "looked at and stayed unknown";
    case AsideReason::kVisited:
      return "visited without progress";
    case AsideReason::kOutOfSight:
      return "seen from no reachable place";
    case AsideReason::kLostThere:
      return "lost or stopped on the way there";
    case AsideReason::kNoDepth:
      return "nothing was measured there: too little texture, or too far?";
    case AsideReason::kIgnored:
      return "ignored by the operator";
    case AsideReason::kTooSmall:
      return "too small to matter";
    case AsideReason::kNoRoom:
      return "no room to turn to it";
    case AsideReason::kNone:
      break;
  }
  return "none";
}

}  // namespace

std::string_view OutcomeText(Outcome outcome) {
  switch (outcome) {
    case Outcome::kComplete:
      return "complete";
    case Outcome::kTooMuchUnknown:
      return "incomplete: too much stayed unknown";
    case Outcome::kNothingReachable:
      return "nothing reachable";
    case Outcome::kNoFreeSpace:
      return "no free space in sight";
    case Outcome::kTimeBudget:
      return "time budget";
    case Outcome::kDistanceBudget:
      return "distance budget";
    case Outcome::kNoPathHome:
      return "no path home";
    case Outcome::kOperator:
      return "ended by the operator";
    case Outcome::kDoesNotApply:
      return "the strategy does not apply";
    case Outcome::kCannotGoOn:
      return "the strategy cannot go on";
  }
  THALWEG_CHECK(false);
  return {};
}

std::string EndingText(const Ending& ending) {
  std::string text(OutcomeText(ending.outcome));
  if (!ending.why.empty()) text += (ending.outcome == Outcome::kCannotGoOn ? ": " : ", ") + ending.why;
  return ending.home_within_budget ? "home within the " + text : text;
}

std::string AsideText(AsideReason reason, bool doubtful) {
  if (!doubtful) return reason == AsideReason::kNone ? "" : std::string(ReasonText(reason));
  if (reason == AsideReason::kNone) return "doubtful";
  if (reason == AsideReason::kLookedAt) return "doubtful: looked at and stayed so";
  return "doubtful: " + std::string(ReasonText(reason));
}

}  // namespace thalweg::explorer
