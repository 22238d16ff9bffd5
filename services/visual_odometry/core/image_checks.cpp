#include "services/visual_odometry/core/image_checks.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace thalweg::visual_odometry {
namespace {

constexpr double kHabit = 0.05;  // weight of a new frame in the running mean

/// Mean magnitude of the detail between two levels of smoothing. Noise, which is finer, mostly averages out.
double SharpnessOf(const cv::Mat& image) {
  cv::Mat coarse;
  cv::Mat detail;
  cv::blur(image, coarse, {5, 5});
  cv::absdiff(image, coarse, detail);
  return cv::mean(detail)[0];
}

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

}  // namespace

Reason ImageChecks::Blind(const cv::Mat& small, Eye eye) const {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(small, mean, deviation);
  if (mean[0] < options_.darkest) return {.kind = Reason::Kind::kDark, .amount = mean[0], .eye = eye};
  if (deviation[0] < options_.least_contrast)
    return {.kind = Reason::Kind::kBlank, .amount = deviation[0], .eye = eye};
  return {};
}

ImageChecks::Findings ImageChecks::Look(const StereoImages& images, const Frame& frame,
                                        const Levels& levels) {
  Findings findings;
  findings.unusable = Blind(frame.left[static_cast<std::size_t>(levels.small)], Eye::kLeft);
  findings.right_blind = Blind(frame.right.back(), Eye::kRight);
  if (options_.detect_frozen && !last_left_.empty()) {
    // A covered lens gives the same blank image every time, which is not a frozen camera.
    const bool left = !findings.unusable && Same(images.left, last_left_);
    const bool right = !findings.right_blind && Same(images.right, last_right_);
    if (left || right) {
      findings.frozen = {.kind = Reason::Kind::kFrozen,
                         .eye = left && right ? Eye::kBoth : (left ? Eye::kLeft : Eye::kRight)};
    }
  }
  images.left.copyTo(last_left_);
  images.right.copyTo(last_right_);
  if (findings.unusable) return findings;

  const double sharpness = SharpnessOf(frame.left[std::min<std::size_t>(1, frame.left.size() - 1)]);
  if (usual_sharpness_ && sharpness < options_.blur * *usual_sharpness_) {
    findings.blurred = {.kind = Reason::Kind::kBlurred, .amount = sharpness / *usual_sharpness_};
  }
  // Blurred images adjust the mean, too, but slowly: the cause may be the place rather than the camera.
  usual_sharpness_ = usual_sharpness_ ? (1.0 - kHabit) * *usual_sharpness_ + kHabit * sharpness : sharpness;
  return findings;
}

}  // namespace thalweg::visual_odometry
