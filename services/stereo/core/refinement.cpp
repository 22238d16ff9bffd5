#include "services/stereo/core/refinement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/check.h"
#include "common/base/parallel.h"
#include "common/base/require.h"
#include "common/base/simd.h"
#include "services/stereo/core/checks.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr std::size_t kRefinementBand = 16;
constexpr float kLongestStep = 0.5F;  // [px]
constexpr int kWidest = 15;           // [px] margin or radius

void Widen(ByteImage& mask, int by) {
  if (by > 0) cv::dilate(ViewOf(mask), ViewOf(mask), cv::Mat::ones(2 * by + 1, 2 * by + 1, CV_8U));
}

void DropEdges(int margin, float jump, DisparityMap& disparity) {
  if (margin == 0) return;
  ByteImage gaps(disparity.width(), disparity.height());
  ByteImage jumps = gaps;
  for (int v = 0; v < disparity.height(); ++v) {
    for (int u = 0; u < disparity.width(); ++u) {
      const float d = disparity(u, v);
      if (std::isnan(d)) gaps(u, v) = 255;
      if (u > 0 && std::abs(disparity(u - 1, v) - d) > jump) jumps(u, v) = jumps(u - 1, v) = 255;
      if (v > 0 && std::abs(disparity(u, v - 1) - d) > jump) jumps(u, v) = jumps(u, v - 1) = 255;
    }
  }
  Widen(gaps, margin);
  Widen(jumps, margin - 1);
  for (std::size_t i = 0; i < disparity.data().size(); ++i) {
    if (gaps.data()[i] != 0 || jumps.data()[i] != 0) disparity.data()[i] = kNoDisparity;
  }
}

/// Computes the mean of the values within `near` of the middle tap's; NaN where that is NaN.
THALWEG_SIMD_CLONES
void MeanOfTaps(const std::vector<const float*>& taps, std::size_t width, float near, std::vector<float>& sum,
                std::vector<float>& count, float* out) {
  const float* const middle = taps[taps.size() / 2];
  std::fill(sum.begin(), sum.end(), 0.0F);
  std::fill(count.begin(), count.end(), 0.0F);
  float* const sums = sum.data();
  float* const counts = count.data();
  for (const float* const tap : taps) {
    for (std::size_t u = 0; u < width; ++u) {
      const bool same = std::abs(tap[u] - middle[u]) <= near;  // false for NaN
      sums[u] += same ? tap[u] : 0.0F;
      counts[u] += same ? 1.0F : 0.0F;
    }
  }
  for (std::size_t u = 0; u < width; ++u) out[u] = sums[u] / counts[u];
}

/// Smooths along the rows, then along the columns.
void Smooth(int radius, float near, std::size_t threads, DisparityMap& disparity) {
  const auto width = static_cast<std::size_t>(disparity.width());
  const auto height = static_cast<std::size_t>(disparity.height());
  const auto reach = static_cast<std::size_t>(radius);
  DisparityMap across(disparity.width(), disparity.height());
  ParallelFor(
      height, kRefinementBand,
      [&](std::size_t v) {
        const float* const row = disparity.Row(static_cast<int>(v));
        std::vector<float> padded(width + 2 * reach, kNoDisparity);
        std::copy_n(row, width, padded.begin() + radius);
        std::vector<const float*> taps;
        for (std::size_t i = 0; i <= 2 * reach; ++i) taps.push_back(padded.data() + i);
        std::vector<float> sum(width);
        std::vector<float> count(width);
        MeanOfTaps(taps, width, near, sum, count, across.Row(static_cast<int>(v)));
      },
      threads);
  const std::vector<float> beyond(width, kNoDisparity);
  ParallelFor(
      height, kRefinementBand,
      [&](std::size_t row) {
        const int v = static_cast<int>(row);
        std::vector<const float*> taps;
        for (int i = v - radius; i <= v + radius; ++i) {
          taps.push_back(i >= 0 && i < across.height() ? across.Row(i) : beyond.data());
        }
        std::vector<float> sum(width);
        std::vector<float> count(width);
        MeanOfTaps(taps, width, near, sum, count, disparity.Row(v));
      },
      threads);
}

/// Window sums of the residual e = left(u) - right(u - d), of the gradient g of the right image at u - d, and
/// of their products.
struct Sums {
  Sums(int width, int height)
      : n(width, height), e(width, height), g(width, height), ge(width, height), gg(width, height) {}
  void OverWindows(int radius) {
    for (Image<float>* const image : {&n, &e, &g, &ge, &gg}) {
      cv::boxFilter(ViewOf(*image), ViewOf(*image), -1, {2 * radius + 1, 2 * radius + 1}, {-1, -1}, false,
                    cv::BORDER_CONSTANT);
    }
  }
  Image<float> n, e, g, ge, gg;
};

void TakeRow(const ByteImage& left, const ByteImage& right, const DisparityMap& disparity, int v,
             float max_difference, Sums& sums) {
  const std::uint8_t* const from = left.Row(v);
  const std::uint8_t* const to = right.Row(v);
  for (int u = 0; u < left.width(); ++u) {
    const float at = static_cast<float>(u) - disparity(u, v);
    if (!(at >= 1.0F && at < static_cast<float>(right.width() - 2))) continue;  // false for NaN
    const int i = static_cast<int>(at);
    const float a = at - static_cast<float>(i);
    const auto between = [a](int before, int after) {
      return (1.0F - a) * static_cast<float>(before) + a * static_cast<float>(after);
    };
    const float e = static_cast<float>(from[u]) - between(to[i], to[i + 1]);
    if (std::abs(e) > max_difference) continue;
    const float g = 0.5F * between(to[i + 1] - to[i - 1], to[i + 2] - to[i]);
    sums.n(u, v) = 1.0F;
    sums.e(u, v) = e;
    sums.g(u, v) = g;
    sums.ge(u, v) = e * g;
    sums.gg(u, v) = g * g;
  }
}

/// Least squares for a disparity step and a brightness offset: with right(u - d - step) = right(u - d) - g
/// step, minimizes the sum of squares of e + g step + offset.
void Step(const ByteImage& left, const ByteImage& right, const RefinementOptions& options,
          std::size_t threads, DisparityMap& disparity) {
  Sums sums(left.width(), left.height());
  ParallelFor(
      static_cast<std::size_t>(left.height()), kRefinementBand,
      [&](std::size_t v) {
        TakeRow(left, right, disparity, static_cast<int>(v), static_cast<float>(options.max_difference),
                sums);
      },
      threads);
  sums.OverWindows(options.radius);
  const auto least = static_cast<float>(options.least_gradient * options.least_gradient);
  for (std::size_t i = 0; i < disparity.data().size(); ++i) {
    const float n = sums.n.data()[i];
    const float g = sums.g.data()[i];
    const float variance = n * sums.gg.data()[i] - g * g;
    const float covariance = n * sums.ge.data()[i] - g * sums.e.data()[i];
    const float step = -covariance / (variance + n * n * least);
    float& d = disparity.data()[i];
    if (n > 0.0F && !std::isnan(d)) d = std::max(0.0F, d + std::clamp(step, -kLongestStep, kLongestStep));
  }
}

}  // namespace

void CheckOptions(const RefinementOptions& options) {
  Require(options.margin >= 0 && options.margin <= kWidest,
          "margin is " + std::to_string(options.margin) + ", must be 0 to 15");
  Require(options.least_region >= 0,
          "least_region is " + std::to_string(options.least_region) + ", must be >= 0");
  Require(options.radius >= 1 && options.radius <= kWidest,
          "radius is " + std::to_string(options.radius) + ", must be 1 to 15");
}

void Refine(const ByteImage& left, const ByteImage& right, const RefinementOptions& options,
            std::size_t threads, DisparityMap& disparity) {
  CheckOptions(options);
  THALWEG_CHECK(left.SameSizeAs(right) && left.SameSizeAs(disparity) && left.channels() == 1 &&
                right.channels() == 1);
  const auto near = static_cast<float>(options.same_surface);
  const auto jump = static_cast<float>(options.jump);
  DropEdges(options.margin, jump, disparity);
  RemoveSmallRegions(disparity, options.least_region, jump);
  Smooth(options.radius, near, threads, disparity);
  Step(left, right, options, threads, disparity);
  Smooth(options.radius, near, threads, disparity);
}

}  // namespace thalweg::stereo
