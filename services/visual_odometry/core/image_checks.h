#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry {

struct ImageCheckOptions {
  double darkest = 8.0;         ///< Mean grey value below which an image is dark.
  double least_contrast = 1.2;  ///< Of the grey values: standard deviation below which nothing is seen.
  double blur = 0.45;           ///< Sharpness relative to the usual, below which an image is blurred.
  /// Whether images equal to the last bit mean a frozen camera. Not for a simulated one without noise.
  bool detect_frozen = true;
};

/// Looks at the images themselves, before anything is matched. Threading: one thread.
class ImageChecks {
 public:
  explicit ImageChecks(const ImageCheckOptions& options) : options_(options) {}

  struct Findings {
    std::string unusable;     ///< Why nothing can be seen with the left eye; empty = one can.
    std::string right_blind;  ///< The same for the right one.
    std::string blurred;      ///< Empty = as sharp as usual.
    std::string frozen;       ///< Empty = not the image before once more.
  };
  /// To be called with each frame once, in order.
  Findings Look(const StereoImages& images, const Frame& frame, const Levels& levels);

 private:
  std::string Blind(const cv::Mat& small, const char* which) const;

  ImageCheckOptions options_;
  cv::Mat last_left_;
  cv::Mat last_right_;
  std::optional<double> usual_sharpness_;
};

}  // namespace thalweg::visual_odometry
