#include "services/explorer/core/scan_pace.h"

#include <algorithm>
#include <vector>

namespace thalweg::explorer {

void ScanPace::Note(Time now) {
  noted_.push_back(now);
  if (noted_.size() > kRemembered + 1) noted_.pop_front();
}

bool ScanPace::Silent(Time now) const {
  if (noted_.empty()) return false;
  const Duration since = now - noted_.back();
  if (noted_.size() == 1) return since > kAtFirst;
  std::vector<Duration> intervals;
  for (std::size_t n = 1; n < noted_.size(); ++n) intervals.push_back(noted_[n] - noted_[n - 1]);
  const auto median = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, median);
  return since > std::max(kLeast, kMissing * *median);
}

void ScanPace::ShiftTimes(Duration back) {
  for (Time& noted : noted_) noted -= back;
}

}  // namespace thalweg::explorer
