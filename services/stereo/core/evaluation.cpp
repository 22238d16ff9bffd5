#include "services/stereo/core/evaluation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/base/check.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr float kAgree = 1.0F;         // [px]
constexpr float kJump = 2.0F;          // [px]
constexpr int kNearDiscontinuity = 9;  // [px] window

bool AgreesWithRight(const DisparityMap& truth_right, int u, int v, float d) {
  const int u_right = static_cast<int>(std::lround(static_cast<float>(u) - d));
  if (u_right < 0 || u_right >= truth_right.width()) return false;
  return std::abs(truth_right(u_right, v) - d) <= kAgree;  // false for NaN
}

/// For each pixel of the right image's row, the largest disparity that the left ground truth projects onto
/// it.
std::vector<float> NearestOnRight(const float* truth, int width) {
  std::vector<float> nearest(static_cast<std::size_t>(width), 0.0F);
  for (int u = 0; u < width; ++u) {
    if (std::isnan(truth[u])) continue;
    const auto u_right = std::lround(static_cast<float>(u) - truth[u]);
    if (u_right < 0) continue;
    float& there = nearest[static_cast<std::size_t>(u_right)];
    there = std::max(there, truth[u]);
  }
  return nearest;
}

bool IsNearest(const std::vector<float>& nearest, int u, float d) {
  const auto u_right = std::lround(static_cast<float>(u) - d);
  return u_right >= 0 && nearest[static_cast<std::size_t>(u_right)] <= d + kAgree;
}

/// Whether the ground truth jumps between this pixel and its right or lower neighbor.
bool JumpsAt(const DisparityMap& truth, int u, int v) {
  const auto differs = [&](int to_u, int to_v) {
    return to_u < truth.width() && to_v < truth.height() && std::abs(truth(u, v) - truth(to_u, to_v)) > kJump;
  };
  return differs(u + 1, v) || differs(u, v + 1);
}

class BadPixels {
 public:
  void Count(bool counts, bool bad) {
    count_ += counts ? 1 : 0;
    bad_ += counts && bad ? 1 : 0;
  }
  double share() const { return bad_ / count_; }  // NaN if none were counted

 private:
  double count_ = 0;
  double bad_ = 0;
};

}  // namespace

EvaluationMasks MasksFrom(const DisparityMap& truth, const std::optional<DisparityMap>& truth_right) {
  THALWEG_CHECK(!truth_right || truth_right->SameSizeAs(truth));
  const ByteImage none(truth.width(), truth.height());
  EvaluationMasks masks{none, none, none};
  ByteImage jumps = none;
  for (int v = 0; v < truth.height(); ++v) {
    const std::vector<float> nearest = NearestOnRight(truth.Row(v), truth.width());
    for (int u = 0; u < truth.width(); ++u) {
      const float d = truth(u, v);
      if (std::isnan(d)) continue;
      masks.all(u, v) = 255;
      const bool seen = truth_right ? AgreesWithRight(*truth_right, u, v, d) : IsNearest(nearest, u, d);
      if (seen) masks.non_occluded(u, v) = 255;
      if (JumpsAt(truth, u, v)) jumps(u, v) = 255;
    }
  }
  cv::Mat near_jumps;
  cv::dilate(ViewOf(jumps), near_jumps, cv::Mat::ones(kNearDiscontinuity, kNearDiscontinuity, CV_8U));
  cv::bitwise_and(near_jumps, ViewOf(masks.non_occluded), ViewOf(masks.near_discontinuities));
  return masks;
}

DisparityMap FillGaps(const DisparityMap& disparity) {
  DisparityMap filled = disparity;
  for (int v = 0; v < filled.height(); ++v) {
    float* const row = filled.Row(v);
    const int width = filled.width();
    for (int begin = 0; begin < width;) {
      if (!std::isnan(row[begin])) {
        ++begin;
        continue;
      }
      int end = begin;
      while (end < width && std::isnan(row[end])) ++end;
      float value = 0.0F;
      if (begin > 0 && end < width) {
        value = std::min(row[begin - 1], row[end]);
      } else if (begin > 0) {
        value = row[begin - 1];
      } else if (end < width) {
        value = row[end];
      }
      std::fill(row + begin, row + end, value);
      begin = end;
    }
  }
  return filled;
}

Evaluation Evaluate(const DisparityMap& disparity, const DisparityMap& truth, const EvaluationMasks& masks,
                    float threshold) {
  THALWEG_CHECK(disparity.SameSizeAs(truth) && masks.all.SameSizeAs(truth) &&
                masks.non_occluded.SameSizeAs(truth) && masks.near_discontinuities.SameSizeAs(truth));
  const DisparityMap filled = FillGaps(disparity);
  BadPixels non_occluded;
  BadPixels near_discontinuities;
  BadPixels all;
  BadPixels matched;
  BadPixels gaps;
  for (int v = 0; v < truth.height(); ++v) {
    for (int u = 0; u < truth.width(); ++u) {
      const bool has_match = !std::isnan(disparity(u, v));
      gaps.Count(true, !has_match);
      const float d = truth(u, v);
      if (std::isnan(d)) continue;
      const bool bad = !(std::abs(filled(u, v) - d) <= threshold);
      non_occluded.Count(masks.non_occluded(u, v) != 0, bad);
      near_discontinuities.Count(masks.near_discontinuities(u, v) != 0, bad);
      all.Count(masks.all(u, v) != 0, bad);
      matched.Count(has_match, bad);
    }
  }
  return {non_occluded.share(), near_discontinuities.share(), all.share(), 1.0 - gaps.share(),
          matched.share()};
}

}  // namespace thalweg::stereo
