#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry {

struct ImageCheckOptions {
  double darkest = 8.0;         ///< Mean gray value below which an image is dark.
  double least_contrast = 1.2;  ///< Standard deviation of gray values below which an image shows nothing.
  double blur = 0.45;           ///< Sharpness, relative to the running mean, below which an image is blurred.
  /// Whether bitwise identical images mean a frozen camera. Disable for a simulated camera without noise.
  bool detect_frozen = true;
};

/// Checks the images themselves, before anything is matched.
///
/// Threading: one thread.
class ImageChecks {
 public:
  explicit ImageChecks(const ImageCheckOptions& options) : options_(options) {}

  struct Findings {
    std::string unusable;     ///< Why the left image cannot be used; empty = it can.
    std::string right_blind;  ///< Why the right image cannot be used; empty = it can.
    std::string blurred;      ///< Empty = as sharp as usual.
    std::string frozen;       ///< Empty = differs from the previous image.
  };
  /// Call once for each frame, in order.
  Findings Look(const StereoImages& images, const Frame& frame, const Levels& levels);

 private:
  std::string Blind(const cv::Mat& small, const char* which) const;

  ImageCheckOptions options_;
  cv::Mat last_left_;
  cv::Mat last_right_;
  std::optional<double> usual_sharpness_;
};

}  // namespace thalweg::visual_odometry
