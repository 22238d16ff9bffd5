#pragma once

#include "common/base/time.h"
#include "services/visual_odometry/core/patch.h"

namespace thalweg::visual_odometry {

/// A rectified pair, both CV_8UC1 and of the camera's size.
struct StereoImages {
  Time stamp;
  cv::Mat left;
  cv::Mat right;
};

/// The levels on which the stages work, whatever the images' size.
struct Levels {
  int search = 0;  ///< Where points are searched in time: about 300 pixels wide.
  int stereo = 0;  ///< Where points are searched along the row.
  int small = 0;   ///< Where rotation is predicted: about 70 pixels wide.
  int count = 1;

  static Levels For(int width_px);
};

/// A pair, ready for matching.
struct Frame {
  Time stamp;
  Pyramid left;
  Pyramid right;
  cv::Mat search;  ///< WithoutLight of left at Levels::search.
};

Frame MakeFrame(const StereoImages& images, const Levels& levels);

}  // namespace thalweg::visual_odometry
