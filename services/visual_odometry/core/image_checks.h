#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/reason.h"

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
    Reason unusable;     ///< Why the left image cannot be used; none = it can.
    Reason right_blind;  ///< Why the right image cannot be used; none = it can.
    Reason blurred;      ///< None = as sharp as usual.
    Reason frozen;       ///< None = differs from the previous image.
  };
  /// Call once for each frame, in order.
  Findings Look(const StereoImages& images, const Frame& frame, const Levels& levels);

 private:
  Reason Blind(const cv::Mat& small, Eye eye) const;

  ImageCheckOptions options_;
  cv::Mat last_left_;
  cv::Mat last_right_;
  std::optional<double> usual_sharpness_;
};

}  // namespace thalweg::visual_odometry
