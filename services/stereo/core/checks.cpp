#include "services/stereo/core/checks.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "services/stereo/core/regions.h"

namespace thalweg::stereo {
void RemoveSmallRegions(DisparityMap& disparity, int min_pixels, float max_step, Connectivity connectivity) {
  if (min_pixels <= 1 || disparity.empty()) return;
  std::vector<float>& d = disparity.data();
  const auto width = static_cast<std::uint32_t>(disparity.width());
  const auto count = static_cast<std::uint32_t>(d.size());
  Regions regions(count);
  const auto joined = [&](std::uint32_t a, std::uint32_t b) { return std::abs(d[a] - d[b]) <= max_step; };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (std::isnan(d[i])) continue;
    if (i % width != 0 && joined(i, i - 1)) regions.Join(i, i - 1);
    if (connectivity == Connectivity::kEight && i >= width) {
      if (i % width != 0 && joined(i, i - width - 1)) regions.Join(i, i - width - 1);
      if ((i + 1) % width != 0 && joined(i, i - width + 1)) regions.Join(i, i - width + 1);
    }
    // If the pixel above, its left neighbor and ours already form one region, there is nothing to join.
    if (i < width || !joined(i, i - width)) continue;
    if (i % width != 0 && joined(i, i - 1) && joined(i - 1, i - 1 - width) &&
        joined(i - width, i - width - 1)) {
      continue;
    }
    regions.Join(i, i - width);
  }
  std::vector<std::uint32_t> sizes(count, 0);
  std::vector<std::uint32_t> roots(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    roots[i] = regions.RootOf(i);
    ++sizes[roots[i]];
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (sizes[roots[i]] < static_cast<std::uint32_t>(min_pixels)) d[i] = kNoDisparity;
  }
}

void CheckRow(const RowChecks& checks, std::span<const Choice> choices, const RightBest& right, float* out) {
  const int width = static_cast<int>(choices.size());
  for (int u = 0; u < width; ++u) {
    const Choice& choice = choices[static_cast<std::size_t>(u)];
    const int d = choice.d;
    out[u] = kNoDisparity;
    const double margin = static_cast<double>(choice.second) - choice.cost;
    if (choice.second == kNever || margin <= checks.uniqueness * choice.cost) continue;
    if (checks.left_right >= 0) {
      const int right_d = right.d[width - 1 - u + d];
      if (std::abs(right_d - d) > checks.left_right) continue;
    }
    out[u] = static_cast<float>(d);
    if (checks.subpixel && choice.before != kNever && choice.after != kNever) {
      out[u] += ParabolaVertex(choice.before, choice.cost, choice.after);
    }
  }
}

}  // namespace thalweg::stereo
