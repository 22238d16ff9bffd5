#include "services/visual_odometry/core/image_checks.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/visual_odometry/core/text.h"

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

std::string ImageChecks::Blind(const cv::Mat& small, const char* which) const {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(small, mean, deviation);
  if (mean[0] < options_.darkest) return std::string(which) + " image is dark: mean " + Fixed(mean[0], 1);
  if (deviation[0] < options_.least_contrast) {
    return std::string(which) + " image shows nothing (covered?): contrast " + Fixed(deviation[0], 1);
  }
  return {};
}

ImageChecks::Findings ImageChecks::Look(const StereoImages& images, const Frame& frame,
                                        const Levels& levels) {
  Findings findings;
  findings.unusable = Blind(frame.left[static_cast<std::size_t>(levels.small)], "left");
  findings.right_blind = Blind(frame.right.back(), "right");
  if (options_.detect_frozen && !last_left_.empty()) {
    // A covered lens gives the same blank image every time, which is not a frozen camera.
    const bool left = findings.unusable.empty() && Same(images.left, last_left_);
    const bool right = findings.right_blind.empty() && Same(images.right, last_right_);
    if (left || right) {
      findings.frozen = std::string(left && right ? "both images are"
                                    : left        ? "left image is"
                                                  : "right image is") +
                        " unchanged since the previous frame";
    }
  }
  images.left.copyTo(last_left_);
  images.right.copyTo(last_right_);
  if (!findings.unusable.empty()) return findings;

  const double sharpness = SharpnessOf(frame.left[std::min<std::size_t>(1, frame.left.size() - 1)]);
  if (usual_sharpness_ && sharpness < options_.blur * *usual_sharpness_) {
    findings.blurred = "image is blurred: sharpness " + Fixed(100.0 * sharpness / *usual_sharpness_, 1) +
                       " % of its usual value";
  }
  // Blurred images adjust the mean, too, but slowly: the cause may be the place rather than the camera.
  usual_sharpness_ = usual_sharpness_ ? (1.0 - kHabit) * *usual_sharpness_ + kHabit * sharpness : sharpness;
  return findings;
}

}  // namespace thalweg::visual_odometry
