#pragma once

#include <algorithm>
#include <vector>

namespace thalweg::testing {

/// The median, of an even number of values the upper one; 0 of none.
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace thalweg::testing
