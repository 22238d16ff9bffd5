#pragma once

#include "common/dds/convert.h"
#include "services/stereo/core/image.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// Copies; mono8 stays grey, all else becomes RGB. Error: a Bayer image of less than 4 x 4 pixels.
Result<ByteImage> ToByteImage(const dds::ImageView& image);

/// The rectified pair that two CameraInfos describe. Error: of different sizes or focal lengths, no baseline,
/// or raw images that would have to be rectified: a distortion, or K other than P.
Result<StereoGeometry> ToStereoGeometry(const sensor_msgs::msg::CameraInfo& left,
                                        const sensor_msgs::msg::CameraInfo& right);

/// Invalid pixels are -1, below min_disparity = 0.
stereo_msgs::msg::DisparityImage ToIdl(Time stamp, const DisparityMap& disparity,
                                       const StereoGeometry& camera, int max_disparity);

}  // namespace thalweg::stereo
