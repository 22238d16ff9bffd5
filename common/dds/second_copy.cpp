#include "common/dds/second_copy.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace thalweg::dds {

std::optional<std::string> FindSecondCopy(const thalweg_msgs::msg::ServiceHealth& mine,
                                          const thalweg_msgs::msg::ServiceHealth& other) {
  constexpr double kStartS = 10.0;
  constexpr double kSameAgeS = 0.5;  // ages travel with the delay of a message
  if (other.service() != mine.service() || other.instance() == mine.instance()) return std::nullopt;
  if (mine.uptime_s() > kStartS) return std::nullopt;
  const double older_s = other.uptime_s() - mine.uptime_s();
  const bool same_age = std::abs(older_s) <= kSameAgeS;
  if (same_age ? other.instance() > mine.instance() : !(older_s > 0.0)) return std::nullopt;
  return fmt::format("another {} runs in this domain already: process {} on {}", mine.service(),
                     other.process_id(), other.host());
}

}  // namespace thalweg::dds
