#include "common/dds/clock_problem.h"

#include <fmt/format.h>

#include <cmath>

#include "common/base/duration_text.h"

namespace thalweg::dds {
namespace {

// [s] The clock and a message may come from different processes, and either may lag by as much.
constexpr double kMostOff = 5.0;

}  // namespace

std::optional<std::string> MissingStamp(Time stamp, Time now) {
  if (stamp != Time{} || Seconds(now - stamp) <= kMostOff) return std::nullopt;
  return "its stamp is 0: set header.stamp by the clock of all services";
}

std::optional<std::string> ClockProblem(Time stamp, Time now) {
  if (auto missing = MissingStamp(stamp, now)) return missing;
  const double ahead = Seconds(stamp - now);
  if (std::abs(ahead) <= kMostOff) return std::nullopt;
  return fmt::format("its stamp is {} {} the clock of all services: does it come from another clock?",
                     DurationText(ahead), ahead > 0.0 ? "ahead of" : "behind");
}

}  // namespace thalweg::dds
