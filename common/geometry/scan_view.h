#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg {

/// Of each of kSide x kSide cells of a depth image: the share of its pixels that have a depth, or that say
/// that there is nothing within range (IsNoReturn), which is as good as one.
///
/// Says where nothing was measured, not why. A stereo matcher has no depth where a surface has too little
/// texture, where all is farther or nearer than it matches, and where one of its cameras sees something else.
struct MeasuredShares {
  static constexpr int kSide = 8;
  std::array<std::uint8_t, kSide * kSide> of_255{};  ///< Row-major from the top left; 255 = all pixels.

  /// Nothing when the cloud is no image: not organised, or with fewer rows or columns than there are cells.
  static std::optional<MeasuredShares> Of(const PointCloud& cloud);

  /// In the cell that a point of C falls in, 0 to 1; nothing when it is outside the image.
  std::optional<double> At(const PinholeCamera& camera, const Eigen::Vector3d& p_C) const;
};

/// Where a sensor was when it measured, and how much it did.
struct ScanView {
  RigidTransform T_WC;
  std::optional<MeasuredShares> measured = std::nullopt;  ///< Nothing: not known.
};

}  // namespace thalweg
