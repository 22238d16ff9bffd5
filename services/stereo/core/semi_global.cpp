#include "services/stereo/core/semi_global.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/require.h"
#include "services/stereo/core/census.h"
#include "services/stereo/core/checks.h"

namespace thalweg::stereo {
namespace {

constexpr int kSemiGlobalBand = 8;

std::size_t Size(int value) {
  return static_cast<std::size_t>(value);
}

/// The path costs of one row, laid out as in PathRow. All paths begin with 0 outside the image.
class PathCosts {
 public:
  PathCosts(std::size_t columns, std::size_t stride, std::uint8_t edge)
      : stride_(stride), data_(columns * (stride + 2 * kLanes), edge) {
    for (std::size_t column = 0; column < columns; ++column) Clear(column);
  }
  void Clear(std::size_t column) {
    const std::size_t begin = column * (stride_ + 2 * kLanes) + kLanes;
    std::fill_n(data_.begin() + static_cast<std::ptrdiff_t>(begin), stride_, std::uint8_t{0});
  }
  std::uint8_t* data() { return data_.data(); }

 private:
  std::size_t stride_;
  std::vector<std::uint8_t> data_;
};

/// The jump penalty of each column on its four paths.
class Jumps {
 public:
  Jumps(const SemiGlobalOptions& options, std::size_t width) : options_(options) {
    for (auto& path : paths_) path.resize(width);
  }
  /// @param before  Row visited before `here`.
  /// @param step    As in PathRow.
  void Take(const std::uint8_t* here, const std::uint8_t* before, int step) {
    const int width = static_cast<int>(paths_[0].size());
    for (int c = 0; c < width; ++c) {
      const int behind = std::clamp(c - step, 0, width - 1);
      const int ahead = std::clamp(c + step, 0, width - 1);
      paths_[0][Size(c)] = Penalty(here[c], here[behind]);
      paths_[1][Size(c)] = Penalty(here[c], before[behind]);
      paths_[2][Size(c)] = Penalty(here[c], before[c]);
      paths_[3][Size(c)] = Penalty(here[c], before[ahead]);
    }
  }
  const std::uint8_t* operator[](std::size_t path) const { return paths_[path].data(); }

 private:
  std::uint8_t Penalty(int a, int b) const {
    const bool edge = std::abs(a - b) > options_.edge;
    return static_cast<std::uint8_t>(edge ? options_.jump_penalty_at_edge : options_.jump_penalty);
  }
  const SemiGlobalOptions& options_;
  std::array<std::vector<std::uint8_t>, 4> paths_;
};

}  // namespace

SemiGlobal::SemiGlobal(const MatcherOptions& options)
    : Matcher(options.max_disparity), options_(options), stride_(Size(StrideFor(options.max_disparity))) {
  const SemiGlobalOptions& best = options.best;
  Require(best.census_weight >= 0 && best.max_difference >= 0 && best.slope_penalty >= 0,
          "census_weight, max_difference and slope_penalty must be >= 0");
  Require(best.jump_penalty >= best.jump_penalty_at_edge && best.jump_penalty_at_edge >= best.slope_penalty,
          "jump_penalty >= jump_penalty_at_edge >= slope_penalty must hold");
  const int largest = best.census_weight * kCensusBits / 4 + best.max_difference + best.jump_penalty;
  Require(best.census_weight * kCensusBits <= 255 && largest + best.slope_penalty <= 255,
          "costs and penalties add up to " + std::to_string(largest + best.slope_penalty) +
              ", must be at most 255");
}

DisparityMap SemiGlobal::Find(const ByteImage& left, const ByteImage& right) {
  const ByteImage gray = ToGray(left);
  const ByteImage gray_right = ToGray(right);
  const std::size_t count = gray.data().size() * stride_;
  std::uint8_t* const costs = costs_.Get(count);
  ComputeCosts(gray, gray_right, costs);
  std::uint16_t* const sums = sums_.Get(count);
  std::uint16_t* more = nullptr;
  if (options_.threads == 1) {
    Aggregate(gray, costs, true, false, sums);
    Aggregate(gray, costs, false, true, sums);
  } else {
    more = more_sums_.Get(count);
    ParallelFor(2, 1, [&](std::size_t i) { Aggregate(gray, costs, i == 0, false, i == 0 ? sums : more); });
  }
  DisparityMap disparity = Choose(gray.width(), gray.height(), sums, more);
  const SemiGlobalOptions& best = options_.best;
  RemoveSmallRegions(disparity, best.speckle_pixels, static_cast<float>(best.speckle_step));
  if (best.fill_surfaces)
    FillSurfaces(left, best.surfaces, static_cast<float>(options_.max_disparity), disparity);
  return disparity;
}

void SemiGlobal::ComputeCosts(const ByteImage& left, const ByteImage& right, std::uint8_t* costs) const {
  const auto threads = Size(options_.threads);
  const std::size_t width = Size(left.width());
  const Image<std::uint64_t> left_census = CensusOf(left, threads);
  const Image<std::uint64_t> right_census = CensusOf(right, threads);
  ParallelFor(
      Size(left.height()), kSemiGlobalBand,
      [&](std::size_t row) {
        const int v = static_cast<int>(row);
        const auto right_bits = Backwards(right_census.Row(v), width, stride_);
        const auto right_gray = Backwards(right.Row(v), width, stride_);
        BestKernels().match_cost(
            left_census.Row(v), right_bits.data() + width - 1, left.Row(v), right_gray.data() + width - 1,
            left.width(), static_cast<int>(stride_), static_cast<std::uint8_t>(options_.best.census_weight),
            static_cast<std::uint8_t>(options_.best.max_difference), costs + row * width * stride_);
      },
      threads);
}

void SemiGlobal::Aggregate(const ByteImage& image, const std::uint8_t* costs, bool downward, bool add,
                           std::uint16_t* sums) const {
  const std::size_t width = Size(image.width());
  const int step = downward ? 1 : -1;
  const auto slope = static_cast<std::uint8_t>(options_.best.slope_penalty);
  const auto edge = static_cast<std::uint8_t>(255 - slope);
  std::array<std::vector<PathCosts>, 2> paths;  // of the previous row and of this one, alternating
  for (auto& row : paths) row.assign(3, PathCosts(width + 2, stride_, edge));
  PathCosts along(2, stride_, edge);
  Jumps jumps(options_.best, width);
  for (int k = 0; k < image.height(); ++k) {
    const int v = downward ? k : image.height() - 1 - k;
    jumps.Take(image.Row(v), image.Row(k == 0 ? v : v - step), step);
    along.Clear(0);
    const std::size_t begin = Size(v) * width * stride_;
    PathRow row{};
    row.width = image.width();
    row.stride = static_cast<int>(stride_);
    row.step = step;
    row.cost = costs + begin;
    for (std::size_t i = 0; i < 4; ++i) row.jump[i] = jumps[i];
    row.slope = slope;
    for (std::size_t i = 0; i < 3; ++i) {
      row.before[i] = paths[Size(k % 2)][i].data();
      row.here[i] = paths[Size((k + 1) % 2)][i].data();
    }
    row.along = along.data();
    row.sum = sums + begin;
    row.add = add;
    BestKernels().aggregate(row);
  }
}

DisparityMap SemiGlobal::Choose(int width, int height, std::uint16_t* sums, const std::uint16_t* more) const {
  DisparityMap disparity(width, height);
  const SemiGlobalOptions& best = options_.best;
  const RowChecks checks{best.uniqueness, best.left_right, true};
  ParallelFor(
      Size(height), kSemiGlobalBand,
      [&](std::size_t row) {
        std::vector<Choice> choices(Size(width));
        std::vector<std::uint16_t> right_cost(Size(width) + stride_);
        std::vector<std::uint16_t> right_d(Size(width) + stride_);
        const RightBest right{right_cost.data(), right_d.data()};
        const std::size_t count = Size(width) * stride_;
        std::uint16_t* const costs = sums + row * count;
        if (more != nullptr) {
          const std::uint16_t* const others = more + row * count;
          for (std::size_t i = 0; i < count; ++i) costs[i] = static_cast<std::uint16_t>(costs[i] + others[i]);
        }
        BestKernels().choose(costs, width, options_.max_disparity, static_cast<int>(stride_), choices.data(),
                             right);
        CheckRow(checks, choices, right, disparity.Row(static_cast<int>(row)));
      },
      Size(options_.threads));
  return disparity;
}

}  // namespace thalweg::stereo
