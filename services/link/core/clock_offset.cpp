#include "services/link/core/clock_offset.h"

#include <algorithm>

namespace thalweg::link {

void ClockOffset::Add(Duration t1, Duration t2, Duration t3, Duration t4) {
  const Duration delay = (t4 - t1) - (t3 - t2);
  if (delay < Duration::zero()) return;  // no clocks behave so
  exchanges_.push_back({((t2 - t1) + (t3 - t4)) / 2, delay});
  if (exchanges_.size() > kExchanges) exchanges_.pop_front();
}

std::optional<ClockOffset::Estimate> ClockOffset::estimate() const {
  if (exchanges_.empty()) return std::nullopt;
  return *std::ranges::min_element(exchanges_, {}, &Estimate::delay);
}

}  // namespace thalweg::link
