#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// For each of kSide x kSide cells of a depth image, the share of its pixels that are measured: those with a
/// depth, and those known to have nothing within range (IsNoReturn).
///
/// Says where measurements are missing, not why. A stereo matcher has no depth where a surface has too
/// little texture, where it is farther or nearer than the disparity range covers, or where one of the cameras
/// sees something else.
struct MeasuredShares {
  static constexpr int kSide = 8;
  std::array<std::uint8_t, kSide * kSide> of_255{};  ///< Row-major from the top left; 255 = all pixels.

  /// Computes the shares; nothing if the cloud is not organized or has fewer rows or columns than there are
  /// cells.
  static std::optional<MeasuredShares> Of(const PointCloud& cloud);

  /// Share, 0 to 1, of the cell onto which a point in C projects; nothing if it lies outside the image.
  std::optional<double> At(const PinholeCamera& camera, const Eigen::Vector3d& p_C) const;
};

/// Where a sensor was when it measured, and how much of its view it measured.
struct ScanView {
  RigidTransform T_WC;
  std::optional<MeasuredShares> measured = std::nullopt;  ///< Nothing if unknown.
};

}  // namespace thalweg
