#pragma once

#include "common/base/time.h"
#include "services/visual_odometry/core/patch.h"

namespace thalweg::visual_odometry {

/// A rectified image pair, both CV_8UC1 and of the camera's size.
struct StereoImages {
  Time stamp;
  cv::Mat left;
  cv::Mat right;
};

/// The pyramid levels used by each stage, chosen by the image's width.
struct Levels {
  int search = 0;  ///< For tracking points over time: about 300 pixels wide.
  int stereo = 0;  ///< For searching points along the row in the right image.
  int small = 0;   ///< For predicting rotation: about 70 pixels wide.
  int count = 1;

  static Levels For(int width_px);
};

/// An image pair, prepared for matching.
struct Frame {
  Time stamp;
  Pyramid left;
  Pyramid right;
  cv::Mat search;  ///< WithoutLight of the left image at Levels::search.
};

Frame MakeFrame(const StereoImages& images, const Levels& levels);

}  // namespace thalweg::visual_odometry
