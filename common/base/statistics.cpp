#include "common/base/statistics.h"

#include <algorithm>
#include <cmath>

namespace thalweg {

TimingStatistics::Summary TimingStatistics::Summarize() const {
  if (samples_ms_.empty()) return {};
  std::vector<double> sorted = samples_ms_;
  std::sort(sorted.begin(), sorted.end());
  const auto rank = [&](double share) {
    const auto n = static_cast<double>(sorted.size());
    const auto index = static_cast<std::size_t>(std::max(1.0, std::ceil(share * n)));
    return sorted[index - 1];
  };
  return {.count = sorted.size(), .p50_ms = rank(0.50), .p95_ms = rank(0.95), .max_ms = sorted.back()};
}

}  // namespace thalweg
