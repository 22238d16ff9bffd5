#include "services/cli/report/remaining_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace thalweg::cli {
namespace {

constexpr double kLeastWatched = 20.0;  // [s]
constexpr double kMostLeft = 0.8;       // of the greatest number of frontiers
constexpr double kMostGrowth = 0.2;     // of the known volume

}  // namespace

std::optional<double> RemainingTime(std::span<const ProgressSample> progress) {
  if (progress.empty()) return std::nullopt;
  const auto number = [](const ProgressSample& sample) { return sample.frontiers.value_or(0); };
  const auto last_peak = std::ranges::max_element(progress.rbegin(), progress.rend(), {}, number);
  const double most = number(*last_peak);
  const double left = number(progress.back());
  const double watched = progress.back().time - last_peak->time;
  if (left < 1.0 || left > kMostLeft * most || watched < kLeastWatched) return std::nullopt;
  const auto half = std::ranges::lower_bound(progress, 0.5 * progress.back().time, {}, &ProgressSample::time);
  if (progress.back().explored > (1.0 + kMostGrowth) * half->explored) return std::nullopt;
  return watched * std::sqrt(left) / (std::sqrt(most) - std::sqrt(left));
}

std::string AboutText(double seconds) {
  if (seconds < 45.0) return "under a minute";
  if (seconds < 5400.0) return fmt::format("about {:.0f} min", std::max(1.0, std::round(seconds / 60.0)));
  return fmt::format("about {:.0f} h", std::round(seconds / 3600.0));
}

}  // namespace thalweg::cli
