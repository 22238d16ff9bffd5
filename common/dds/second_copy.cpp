#include "common/dds/second_copy.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "common/base/text.h"

namespace thalweg::dds {

std::optional<std::string> FindSecondCopy(const thalweg_msgs::msg::ServiceHealth& mine,
                                          const thalweg_msgs::msg::ServiceHealth& other, Duration at_work) {
  constexpr auto kStart = std::chrono::seconds(10);
  constexpr double kSameAgeS = 0.5;  // ages travel with the delay of a message
  if (other.service() != mine.service() || other.instance() == mine.instance()) return std::nullopt;
  if (at_work > kStart) return std::nullopt;
  const double older_s = other.uptime_s() - mine.uptime_s();
  const bool same_age = std::abs(older_s) <= kSameAgeS;
  if (same_age ? other.instance() > mine.instance() : !(older_s > 0.0)) return std::nullopt;
  return fmt::format("another {} runs in this domain already: process {} on {}", mine.service(),
                     other.process_id(), CleanText(other.host()));
}

}  // namespace thalweg::dds
