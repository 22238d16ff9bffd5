#include "services/explorer/adapter/convert.h"

namespace thalweg::explorer {

thalweg_msgs::msg::AsideReason ToIdl(AsideReason reason) {
  switch (reason) {
    case AsideReason::kLookedAt:
      return thalweg_msgs::msg::ASIDE_LOOKED_AT;
    case AsideReason::kVisited:
      return thalweg_msgs::msg::ASIDE_VISITED;
    case AsideReason::kOutOfSight:
      return thalweg_msgs::msg::ASIDE_OUT_OF_SIGHT;
    case AsideReason::kLostThere:
      return thalweg_msgs::msg::ASIDE_LOST_THERE;
    case AsideReason::kNoDepth:
      return thalweg_msgs::msg::ASIDE_NO_DEPTH;
    case AsideReason::kIgnored:
      return thalweg_msgs::msg::ASIDE_IGNORED;
    case AsideReason::kTooSmall:
      return thalweg_msgs::msg::ASIDE_TOO_SMALL;
    case AsideReason::kNoRoom:
      return thalweg_msgs::msg::ASIDE_NO_ROOM;
    case AsideReason::kNone:
      break;
  }
  return thalweg_msgs::msg::ASIDE_NONE;
}

AsideReason FromIdl(thalweg_msgs::msg::AsideReason reason) {
  for (const AsideReason known : kAsideReasons) {
    if (ToIdl(known) == reason) return known;
  }
  return AsideReason::kNone;
}

thalweg_msgs::msg::ExplorationOutcome ToIdl(Outcome outcome) {
  switch (outcome) {
    case Outcome::kComplete:
      return thalweg_msgs::msg::OUTCOME_COMPLETE;
    case Outcome::kTooMuchUnknown:
      return thalweg_msgs::msg::OUTCOME_TOO_MUCH_UNKNOWN;
    case Outcome::kNothingReachable:
      return thalweg_msgs::msg::OUTCOME_NOTHING_REACHABLE;
    case Outcome::kNoFreeSpace:
      return thalweg_msgs::msg::OUTCOME_NO_FREE_SPACE;
    case Outcome::kTimeBudget:
      return thalweg_msgs::msg::OUTCOME_TIME_BUDGET;
    case Outcome::kDistanceBudget:
      return thalweg_msgs::msg::OUTCOME_DISTANCE_BUDGET;
    case Outcome::kNoPathHome:
      return thalweg_msgs::msg::OUTCOME_NO_PATH_HOME;
    case Outcome::kDoesNotApply:
      return thalweg_msgs::msg::OUTCOME_DOES_NOT_APPLY;
    case Outcome::kCannotGoOn:
      return thalweg_msgs::msg::OUTCOME_CANNOT_GO_ON;
    case Outcome::kOperator:
      break;
  }
  return thalweg_msgs::msg::OUTCOME_OPERATOR;
}

std::optional<Outcome> FromIdl(thalweg_msgs::msg::ExplorationOutcome outcome) {
  for (const Outcome known : kOutcomes) {
    if (ToIdl(known) == outcome) return known;
  }
  return std::nullopt;
}

}  // namespace thalweg::explorer
