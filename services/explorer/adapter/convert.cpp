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

}  // namespace thalweg::explorer
