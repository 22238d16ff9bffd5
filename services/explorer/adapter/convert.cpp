#include "services/explorer/adapter/convert.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/base/check.h"

namespace thalweg::explorer {
namespace {

constexpr std::array kReasons = {
    std::pair{AsideReason::kNone, thalweg_msgs::msg::ASIDE_NONE},
    std::pair{AsideReason::kLookedAt, thalweg_msgs::msg::ASIDE_LOOKED_AT},
    std::pair{AsideReason::kVisited, thalweg_msgs::msg::ASIDE_VISITED},
    std::pair{AsideReason::kOutOfSight, thalweg_msgs::msg::ASIDE_OUT_OF_SIGHT},
    std::pair{AsideReason::kLostThere, thalweg_msgs::msg::ASIDE_LOST_THERE},
    std::pair{AsideReason::kNoDepth, thalweg_msgs::msg::ASIDE_NO_DEPTH},
    std::pair{AsideReason::kIgnored, thalweg_msgs::msg::ASIDE_IGNORED},
    std::pair{AsideReason::kTooSmall, thalweg_msgs::msg::ASIDE_TOO_SMALL},
};

}  // namespace

thalweg_msgs::msg::AsideReason ToIdl(AsideReason reason) {
  const auto* const found = std::ranges::find(kReasons, reason, [](const auto& pair) { return pair.first; });
  THALWEG_CHECK(found != kReasons.end());
  return found->second;
}

AsideReason FromIdl(thalweg_msgs::msg::AsideReason reason) {
  const auto* const found = std::ranges::find(kReasons, reason, [](const auto& pair) { return pair.second; });
  return found == kReasons.end() ? AsideReason::kNone : found->first;
}

}  // namespace thalweg::explorer
