#include "tests/services/stereo/support/slow_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace thalweg::stereo::test {
namespace {

/// Outside the image, the border pixels are repeated.
int At(const ByteImage& image, int u, int v) {
  return image(std::clamp(u, 0, image.width() - 1), std::clamp(v, 0, image.height() - 1));
}

int WindowSum(const ByteImage& left, const ByteImage& right, int u, int v, int d, int radius, int cut) {
  int sum = 0;
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      sum += std::min(cut, std::abs(At(left, u + i, v + j) - At(right, u + i - d, v + j)));
    }
  }
  return sum;
}

int SlowHamming(const ByteImage& left, const ByteImage& right, int u, int v, int u_right) {
  int differing = 0;
  for (int j = -3; j <= 3; ++j) {
    for (int i = -4; i <= 4; ++i) {
      const bool in_left = At(left, u + i, v + j) < left(u, v);
      const int middle = At(right, u_right, v);
      // Outside the right image, the census is that of its border pixel.
      const int base = std::max(u_right, 0);
      const bool in_right = At(right, base + i, v + j) < middle;
      differing += in_left != in_right ? 1 : 0;
    }
  }
  return differing;
}

}  // namespace

int SlowSad5(const ByteImage& left, const ByteImage& right, int u, int v, int d, int window, int cut) {
  const int radius = window / 2;
  std::array<int, 4> supports{};
  std::size_t k = 0;
  for (const int j : {-radius, radius}) {
    for (const int i : {-radius, radius})
      supports[k++] = WindowSum(left, right, u + i, v + j, d, radius, cut);
  }
  std::sort(supports.begin(), supports.end());
  return WindowSum(left, right, u, v, d, radius, cut) + supports[0] + supports[1];
}

std::vector<float> SlowChoose(const std::vector<Costs>& costs, double uniqueness, int left_right,
                              bool subpixel) {
  const int width = static_cast<int>(costs.size());
  const auto cost = [&](int u, int d) {
    return costs[static_cast<std::size_t>(u)][static_cast<std::size_t>(d)];
  };
  const int count = static_cast<int>(costs[0].size());
  const auto candidates = [&](int u) { return std::min(count, u + 1); };
  const auto best_of_right = [&](int u_right) {
    int best = 0;
    for (int d = 0; d < count && u_right + d < width; ++d) {
      if (cost(u_right + d, d) < cost(u_right + best, best)) best = d;
    }
    return best;
  };
  std::vector<float> out(costs.size(), kNoDisparity);
  for (int u = 0; u < width; ++u) {
    int best = 0;
    for (int d = 1; d < candidates(u); ++d) {
      if (cost(u, d) < cost(u, best)) best = d;
    }
    int second = std::numeric_limits<int>::max();
    for (int d = 0; d < candidates(u); ++d) {
      if (std::abs(d - best) > 1) second = std::min(second, cost(u, d));
    }
    const double c1 = cost(u, best);
    if (second == std::numeric_limits<int>::max() || second - c1 <= uniqueness * c1) continue;
    if (left_right >= 0 && std::abs(best_of_right(u - best) - best) > left_right) continue;
    float d = static_cast<float>(best);
    if (subpixel && best > 0 && best + 1 < candidates(u)) {
      const auto before = static_cast<float>(cost(u, best - 1));
      const auto after = static_cast<float>(cost(u, best + 1));
      const float curvature = before - 2.0F * static_cast<float>(c1) + after;
      if (curvature > 0.0F) d += 0.5F * (before - after) / curvature;
    }
    out[static_cast<std::size_t>(u)] = d;
  }
  return out;
}

DisparityMap SlowlyRemoved(const DisparityMap& disparity, int min_pixels, float max_step,
                           Connectivity connectivity) {
  std::vector<std::pair<int, int>> steps = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  if (connectivity == Connectivity::kEight) steps.insert(steps.end(), {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}});
  DisparityMap out = disparity;
  for (int v = 0; v < disparity.height(); ++v) {
    for (int u = 0; u < disparity.width(); ++u) {
      std::vector<std::pair<int, int>> region = {{u, v}};
      Image<int> seen(disparity.width(), disparity.height());
      seen(u, v) = 1;
      for (std::size_t i = 0; i < region.size(); ++i) {
        const auto [x, y] = region[i];
        for (const auto& [dx, dy] : steps) {
          const int a = x + dx;
          const int b = y + dy;
          if (a < 0 || b < 0 || a >= disparity.width() || b >= disparity.height() || seen(a, b) != 0)
            continue;
          if (!(std::abs(disparity(a, b) - disparity(x, y)) <= max_step)) continue;
          seen(a, b) = 1;
          region.emplace_back(a, b);
        }
      }
      if (static_cast<int>(region.size()) < min_pixels) out(u, v) = kNoDisparity;
    }
  }
  return out;
}

DisparityMap SlowSemiGlobal(const ByteImage& left, const ByteImage& right, int max_disparity,
                            const SemiGlobalOptions& options) {
  const int width = left.width();
  const int height = left.height();
  // Paths include disparities beyond the last, up to a whole number of vectors.
  const int count = (max_disparity + 31) / 32 * 32;
  const auto index = [&](int u, int v) { return static_cast<std::size_t>(v * width + u); };
  std::vector<Costs> costs(left.data().size(), Costs(static_cast<std::size_t>(count)));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      for (int d = 0; d < count; ++d) {
        const int difference = std::abs(left(u, v) - At(right, u - d, v));
        costs[index(u, v)][static_cast<std::size_t>(d)] =
            options.census_weight * SlowHamming(left, right, u, v, u - d) / 4 +
            std::min(difference, options.max_difference);
      }
    }
  }
  std::vector<Costs> sums(left.data().size(), Costs(static_cast<std::size_t>(count), 0));
  constexpr std::array<std::array<int, 2>, 8> kDirections = {
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};
  for (const auto& [du, dv] : kDirections) {
    std::vector<Costs> paths(left.data().size(), Costs(static_cast<std::size_t>(count)));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int u = du >= 0 ? x : width - 1 - x;
        const int v = dv >= 0 ? y : height - 1 - y;
        const int from_u = u - du;
        const int from_v = v - dv;
        const bool begins = from_u < 0 || from_v < 0 || from_u >= width || from_v >= height;
        const Costs before =
            begins ? Costs(static_cast<std::size_t>(count), 0) : paths[index(from_u, from_v)];
        // The jump penalty from outside does not matter, since all paths begin with 0.
        const bool edge = !begins && std::abs(left(u, v) - left(from_u, from_v)) > options.edge;
        const int jump = edge ? options.jump_penalty_at_edge : options.jump_penalty;
        const int least = *std::min_element(before.begin(), before.end());
        Costs& here = paths[index(u, v)];
        for (std::size_t d = 0; d < here.size(); ++d) {
          int cheapest = std::min(before[d], least + jump);
          if (d > 0) cheapest = std::min(cheapest, before[d - 1] + options.slope_penalty);
          if (d + 1 < here.size()) cheapest = std::min(cheapest, before[d + 1] + options.slope_penalty);
          here[d] = costs[index(u, v)][d] + cheapest - least;
        }
        // Stored minus the minimum, which keeps values small and changes no choice.
        const int own = *std::min_element(here.begin(), here.end());
        for (std::size_t d = 0; d < here.size(); ++d) {
          here[d] -= own;
          sums[index(u, v)][d] += here[d];
        }
      }
    }
  }
  DisparityMap disparity(width, height);
  for (int v = 0; v < height; ++v) {
    std::vector<Costs> row;
    for (int u = 0; u < width; ++u) {
      Costs candidates = sums[index(u, v)];
      candidates.resize(static_cast<std::size_t>(max_disparity));
      row.push_back(candidates);
    }
    const std::vector<float> chosen = SlowChoose(row, options.uniqueness, options.left_right, true);
    std::copy(chosen.begin(), chosen.end(), disparity.Row(v));
  }
  return disparity;
}

}  // namespace thalweg::stereo::test
