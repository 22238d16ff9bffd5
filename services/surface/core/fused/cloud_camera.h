#pragma once

#include "common/base/result.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"

namespace thalweg::surface {

/// The camera that an organized cloud was taken with, from its points alone: a point (x, y, z) of pixel (u,
/// v) has u = fx x / z + cx and v = fy y / z + cy, whatever the error of its depth; two straight lines,
/// fitted by least squares.
///
/// Error, if the cloud is not organized, if its points do not span enough of the image to tell, or if they
/// are not those of one pinhole camera: if one of them is not where its pixel is.
Result<PinholeCamera> CameraOf(const PointCloud& cloud);

/// Whether both have the same size, and every pixel the same ray, within a pixel.
bool IsSameCamera(const PinholeCamera& a, const PinholeCamera& b);

}  // namespace thalweg::surface
