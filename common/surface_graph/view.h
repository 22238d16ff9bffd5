#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/depth_image.h"
#include "common/geometry/plausible.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/stereo_geometry.h"

namespace thalweg::surface {

/// A disparity image D with the pose c that it was taken from.
struct View {
  StereoGeometry rig;
  /// [px] width * height disparities, row-major. A pixel is valid if its disparity is finite and positive,
  /// and what it shows at most kFarthest away.
  std::vector<float> disparities;
  std::vector<Rgb> colors;  ///< width * height, or empty.
  RigidTransform T_WC = RigidTransform::Identity();

  int width_px() const { return rig.camera.width_px; }
  int height_px() const { return rig.camera.height_px; }
  std::size_t PixelAt(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px()) + static_cast<std::size_t>(u);
  }
  /// Whether a pixel has a measurement at all.
  bool HasMeasurement() const;
  bool IsValid(std::size_t pixel) const {
    return std::isfinite(disparities[pixel]) && disparities[pixel] > 0.0F && DepthAt(pixel) <= kFarthest;
  }
  /// [m] z = f b / d of a valid pixel.
  double DepthAt(std::size_t pixel) const { return rig.camera.fx * rig.baseline / disparities[pixel]; }
  /// The point in C that a valid pixel shows, pi(r, c) = [b c / d, b r / d, f b / d] with r and c from the
  /// principal point. Departure: pixels need not be square, so that y = (v - cy) / fy z.
  Eigen::Vector3d PointAt(std::size_t pixel) const {
    const auto width = static_cast<std::size_t>(width_px());
    return DepthAt(pixel) *
           rig.camera.RayAtUnitDepth(static_cast<double>(pixel % width), static_cast<double>(pixel / width));
  }
  /// The pixel nearest to where a point in C appears; nothing if that is behind the camera or outside.
  std::optional<std::size_t> PixelOf(const Eigen::Vector3d& p_C) const {
    const std::optional<Eigen::Vector2d> uv = rig.camera.Project(p_C);
    if (!uv) return std::nullopt;
    return PixelAt(static_cast<int>(std::floor(uv->x() + 0.5)), static_cast<int>(std::floor(uv->y() + 0.5)));
  }
};

/// Describes the first error of a view, naming the field; nothing if it is valid. Disparities that are not
/// positive numbers are no error: they are what is not measured.
std::optional<std::string> MistakeIn(const View& view);

/// The disparities d = f b / z that a stereo camera would have measured.
std::vector<float> DisparitiesOf(const DepthImage& depth, const StereoGeometry& rig);

}  // namespace thalweg::surface
