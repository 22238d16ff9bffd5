#include "common/geometry/cloud_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/size_text.h"
#include "common/base/text.h"

namespace thalweg {
namespace {

constexpr double kFartherThanRounding = 0.25;  // [px] between a point and its pixel
constexpr double kLeastSpread = 0.2;           // of the points over the image, as a share of its edge

/// The straight line pixel = slope * ray + offset.
struct Line {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void Add(double ray, double pixel) {
    n += 1.0;
    x += ray;
    y += pixel;
    xx += ray * ray;
    xy += ray * pixel;
    yy += pixel * pixel;
  }
  double slope() const { return (n * xy - x * y) / (n * xx - x * x); }
  double offset() const { return (y - slope() * x) / n; }
  double deviation() const { return std::sqrt(std::max(0.0, n * yy - y * y)) / n; }  ///< [px] of the pixels
};

/// Calls visit(u, v, point) for each point that was measured.
template <class Visitor>
void ForEachPoint(const PointCloud& cloud, Visitor&& visit) {
  std::size_t pixel = 0;
  for (int v = 0; v < cloud.height_px; ++v) {
    for (int u = 0; u < cloud.width_px; ++u, ++pixel) {
      const Eigen::Vector3d p_C = cloud.points_C[pixel].cast<double>();
      if (p_C.allFinite() && p_C.z() > 0.0) visit(u, v, p_C);
    }
  }
}

/// [px] The largest distance of a point from its pixel, along one axis.
double FarthestFromItsPixel(const PinholeCamera& camera, const PointCloud& cloud) {
  double farthest = 0.0;
  ForEachPoint(cloud, [&](int u, int v, const Eigen::Vector3d& p_C) {
    farthest = std::max({farthest, std::abs(camera.fx * p_C.x() / p_C.z() + camera.cx - u),
                         std::abs(camera.fy * p_C.y() / p_C.z() + camera.cy - v)});
  });
  return farthest;
}

}  // namespace

Result<std::optional<PinholeCamera>> CameraOf(const PointCloud& cloud) {
  if (cloud.width_px < 2 || cloud.height_px < 2) {
    return Error{"is not organized: " + SizeText(cloud.width_px, cloud.height_px)};
  }
  Line columns;
  Line rows;
  ForEachPoint(cloud, [&](int u, int v, const Eigen::Vector3d& p_C) {
    columns.Add(p_C.x() / p_C.z(), u);
    rows.Add(p_C.y() / p_C.z(), v);
  });
  // Points spread evenly over a share of an edge deviate by this share of it over the root of 12.
  const auto is_enough = [](const Line& line, int edge) {
    return line.n >= 2.0 && line.deviation() * std::sqrt(12.0) >= kLeastSpread * edge;
  };
  if (!is_enough(columns, cloud.width_px) || !is_enough(rows, cloud.height_px)) {
    return std::optional<PinholeCamera>();
  }
  const PinholeCamera camera{.width_px = cloud.width_px,
                             .height_px = cloud.height_px,
                             .fx = columns.slope(),
                             .fy = rows.slope(),
                             .cx = columns.offset(),
                             .cy = rows.offset()};
  const double farthest = FarthestFromItsPixel(camera, cloud);
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!is_length(camera.fx) || !is_length(camera.fy) || !(farthest <= kFartherThanRounding)) {
    return Error{"is not of one pinhole camera: a point is " + NumberText(farthest) + " pixels from its own"};
  }
  return std::optional(camera);
}

bool Fits(const PinholeCamera& camera, const PointCloud& cloud) {
  return camera.width_px == cloud.width_px && camera.height_px == cloud.height_px &&
         FarthestFromItsPixel(camera, cloud) <= kFartherThanRounding;
}

std::optional<Eigen::Vector3f> PointLookedAt(const PointCloud& cloud, const PinholeCamera& camera,
                                             double max_range) {
  std::optional<Eigen::Vector3f> nearest;
  double least = std::numeric_limits<double>::infinity();
  std::size_t pixel = 0;
  for (int v = 0; v < cloud.height_px; ++v) {
    for (int u = 0; u < cloud.width_px; ++u, ++pixel) {
      const double from_axis = (u - camera.cx) * (u - camera.cx) + (v - camera.cy) * (v - camera.cy);
      if (from_axis >= least) continue;
      const Eigen::Vector3f& p_C = cloud.points_C[pixel];
      if (!(static_cast<double>(p_C.norm()) <= max_range)) continue;  // NaN and infinity neither
      least = from_axis;
      nearest = p_C;
    }
  }
  return nearest;
}

bool IsSameCamera(const PinholeCamera& a, const PinholeCamera& b) {
  if (a.width_px != b.width_px || a.height_px != b.height_px) return false;
  // Rays are linear in pixels, so that the corners decide for all others.
  for (const double u : {0.0, a.width_px - 1.0}) {
    for (const double v : {0.0, a.height_px - 1.0}) {
      const Eigen::Vector3d ray = a.RayAtUnitDepth(u, v);
      if (std::abs(b.fx * ray.x() + b.cx - u) > 1.0 || std::abs(b.fy * ray.y() + b.cy - v) > 1.0)
        return false;
    }
  }
  return true;
}

bool SteadyCamera::Accepts(const PinholeCamera& camera) {
  const auto is = [&](const std::optional<PinholeCamera>& known) {
    return known && IsSameCamera(*known, camera);
  };
  in_a_row_ = is(camera_) ? 0 : is(other_) ? in_a_row_ + 1 : 1;
  if (camera_ && in_a_row_ > 0 && in_a_row_ < kToStay) {
    other_ = camera;
    return false;
  }
  camera_ = camera;
  other_.reset();
  in_a_row_ = 0;
  return true;
}

}  // namespace thalweg
