#pragma once

#include <array>
#include <optional>

#include "common/camera/stereo_rectifier.h"
#include "common/dds/convert.h"
#include "services/stereo/core/image.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// Copies an image; mono8 stays gray, everything else becomes RGB. Error: a Bayer image smaller than 4 x 4
/// pixels.
Result<ByteImage> ToByteImage(const dds::ImageView& image);

/// What two CameraInfos say about the images they belong to.
struct StereoInfo {
  StereoGeometry geometry;  ///< The rectified images'.
  /// How to rectify raw images, left and right; nothing if the images are already rectified.
  std::optional<std::array<Rectification, 2>> rectifications;
};
/// Combines two CameraInfos. Images count as rectified if d is 0, r the identity and k equal to the left part
/// of p, for both. Error: different sizes or focal lengths once rectified, no baseline, or a distortion model
/// that is not OpenCV's.
Result<StereoInfo> FromIdl(const sensor_msgs::msg::CameraInfo& left,
                           const sensor_msgs::msg::CameraInfo& right);

/// Encodes a disparity image. Invalid pixels are -1, below min_disparity = 0.
stereo_msgs::msg::DisparityImage ToIdl(Time stamp, const DisparityMap& disparity,
                                       const StereoGeometry& camera, int max_disparity);

}  // namespace thalweg::stereo
