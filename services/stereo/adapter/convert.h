#pragma once

#include <array>
#include <optional>

#include "common/camera/stereo_rectifier.h"
#include "common/dds/convert.h"
#include "services/stereo/core/image.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// Copies; mono8 stays grey, all else becomes RGB. Error: a Bayer image of less than 4 x 4 pixels.
Result<ByteImage> ToByteImage(const dds::ImageView& image);

/// What two CameraInfos say of the images beside them.
struct StereoInfo {
  StereoGeometry geometry;  ///< Of the images once they are rectified.
  /// How raw images become so, left and right; none: they are.
  std::optional<std::array<Rectification, 2>> rectifications;
};
/// The images are taken as rectified where d is 0, r the identity and k the left part of p, both times.
/// Error: of different sizes or focal lengths once rectified, no baseline, a lens that is not OpenCV's.
Result<StereoInfo> FromIdl(const sensor_msgs::msg::CameraInfo& left,
                           const sensor_msgs::msg::CameraInfo& right);

/// Invalid pixels are -1, below min_disparity = 0.
stereo_msgs::msg::DisparityImage ToIdl(Time stamp, const DisparityMap& disparity,
                                       const StereoGeometry& camera, int max_disparity);

}  // namespace thalweg::stereo
