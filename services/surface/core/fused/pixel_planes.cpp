#include "services/surface/core/fused/pixel_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/check.h"

namespace thalweg::surface {
namespace {

constexpr double kExactTolerance = 0.1;  // share of the tolerance that residuals of an exact sensor may have
constexpr double kLikely = 1.5;          // residuals of a plane are hardly larger than this many sigma

/// Half the edge of the least window whose slope is known well enough: the variance of the slope over a
/// window of (2 k + 1)^2 pixels is sigma^2 / ((2 k + 1)^2 k (k + 1) / 3), and a slope of a is a component of
/// the normal of a f z, at most.
int HalfWindow(const DepthErrorModel& error, double f, double z) {
  const int most = std::max(1, error.window_px / 2);
  for (int k = 1; k < most; ++k) {
    const double edge = 2.0 * k + 1.0;
    const double slope = error.sigma / std::sqrt(edge * edge * k * (k + 1.0) / 3.0);
    if (slope * f * z <= PixelPlanes::kNormalError) return k;
  }
  return most;
}

struct Side {
  int left, top, right, bottom;  // in units of the half window, from the pixel
};
constexpr std::array<Side, 9> kSides = {Side{-1, -1, 1, 1}, Side{-1, -1, 0, 1}, Side{0, -1, 1, 1},
                                        Side{-1, -1, 1, 0}, Side{-1, 0, 1, 1},  Side{-1, -1, 0, 0},
                                        Side{0, -1, 1, 0},  Side{-1, 0, 0, 1},  Side{0, 0, 1, 1}};

}  // namespace

void PixelPlanes::Compute(const PointCloud& cloud, const PinholeCamera& camera, const DepthErrorModel& error,
                          double tolerance) {
  const std::size_t count = cloud.points_C.size();
  THALWEG_CHECK(cloud.width_px == camera.width_px && cloud.height_px == camera.height_px);
  THALWEG_CHECK(count ==
                static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px));
  width_ = cloud.width_px;
  height_ = cloud.height_px;
  Sum(cloud);
  planes_.assign(count, {});
  std::size_t pixel = 0;
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u, ++pixel) {
      const Eigen::Vector3f& p_C = cloud.points_C[pixel];
      if (!p_C.allFinite() || p_C.z() <= 0.0F) continue;
      FitPlane(u, v, p_C, camera, error, tolerance, planes_[pixel]);
    }
  }
  CompareNeighbors(cloud, error, tolerance);
}

void PixelPlanes::Sum(const PointCloud& cloud) {
  const auto stride = static_cast<std::size_t>(width_) + 1;
  sums_.assign(stride * (static_cast<std::size_t>(height_) + 1), {});
  std::size_t pixel = 0;
  for (int v = 0; v < height_; ++v) {
    Sums row;
    for (int u = 0; u < width_; ++u, ++pixel) {
      const Eigen::Vector3f& p_C = cloud.points_C[pixel];
      if (p_C.allFinite() && p_C.z() > 0.0F) {
        const double w = 1.0 / static_cast<double>(p_C.z());
        row.n += 1.0;
        row.u += u;
        row.v += v;
        row.uu += u * u;
        row.uv += u * v;
        row.vv += v * v;
        row.w += w;
        row.uw += u * w;
        row.vw += v * w;
        row.ww += w * w;
      }
      const std::size_t here = (static_cast<std::size_t>(v) + 1) * stride + static_cast<std::size_t>(u) + 1;
      const Sums& above = sums_[here - stride];
      sums_[here] = {above.n + row.n,   above.u + row.u,   above.v + row.v, above.uu + row.uu,
                     above.uv + row.uv, above.vv + row.vv, above.w + row.w, above.uw + row.uw,
                     above.vw + row.vw, above.ww + row.ww};
    }
  }
}

PixelPlanes::Sums PixelPlanes::Within(int left, int top, int right, int bottom) const {
  const auto at = [&](int u, int v) -> const Sums& {
    return sums_[static_cast<std::size_t>(v) * (static_cast<std::size_t>(width_) + 1) +
                 static_cast<std::size_t>(u)];
  };
  const Sums& a = at(right + 1, bottom + 1);
  const Sums& b = at(left, bottom + 1);
  const Sums& c = at(right + 1, top);
  const Sums& d = at(left, top);
  return {a.n - b.n - c.n + d.n,     a.u - b.u - c.u + d.u,     a.v - b.v - c.v + d.v,
          a.uu - b.uu - c.uu + d.uu, a.uv - b.uv - c.uv + d.uv, a.vv - b.vv - c.vv + d.vv,
          a.w - b.w - c.w + d.w,     a.uw - b.uw - c.uw + d.uw, a.vw - b.vw - c.vw + d.vw,
          a.ww - b.ww - c.ww + d.ww};
}

bool PixelPlanes::FitTo(int u, int v, int left, int top, int right, int bottom, Fit& fit) const {
  const Sums s =
      Within(std::max(0, left), std::max(0, top), std::min(width_ - 1, right), std::min(height_ - 1, bottom));
  if (s.n < 3.0) return false;
  // Moments about the mean, so that the equations of slope and value come apart.
  const double mu = s.u / s.n;
  const double mv = s.v / s.n;
  const double mw = s.w / s.n;
  const double uu = s.uu - s.n * mu * mu;
  const double uv = s.uv - s.n * mu * mv;
  const double vv = s.vv - s.n * mv * mv;
  const double uw = s.uw - s.n * mu * mw;
  const double vw = s.vw - s.n * mv * mw;
  const double ww = s.ww - s.n * mw * mw;
  const double determinant = uu * vv - uv * uv;
  if (determinant < 0.1) return false;  // on one line
  fit.a = (uw * vv - vw * uv) / determinant;
  fit.b = (vw * uu - uw * uv) / determinant;
  const double du = u - mu;
  const double dv = v - mv;
  fit.c = mw + fit.a * du + fit.b * dv;
  fit.residual = std::sqrt(std::max(0.0, ww - fit.a * uw - fit.b * vw) / s.n);
  fit.variance = 1.0 / s.n + (du * du * vv - 2.0 * du * dv * uv + dv * dv * uu) / determinant;
  return true;
}

void PixelPlanes::FitPlane(int u, int v, const Eigen::Vector3f& p_C, const PinholeCamera& camera,
                           const DepthErrorModel& error, double tolerance, PixelPlane& plane) const {
  const double z = p_C.z();
  const double own = 1.0 / z;
  const int k = error.sigma > 0.0 ? HalfWindow(error, std::max(camera.fx, camera.fy), z) : 1;
  const double expected = kLikely * error.sigma + kExactTolerance * tolerance / (z * z);
  Fit best{0, 0, 0, std::numeric_limits<double>::infinity(), 0};
  for (const Side& side : kSides) {
    Fit fit{};
    if (!FitTo(u, v, u + k * side.left, v + k * side.top, u + k * side.right, v + k * side.bottom, fit))
      continue;
    if (fit.residual < best.residual) best = fit;
    if (best.residual <= expected) break;
  }
  if (!std::isfinite(best.residual)) return;
  const bool averaged = error.sigma > 0.0 && best.residual <= expected && best.variance < 1.0 && best.c > 0.0;
  const double c = averaged ? best.c : own;
  const double depth = 1.0 / c;
  Eigen::Vector3d m(best.a * camera.fx, best.b * camera.fy, 0.0);
  m.z() = c + best.a * (camera.cx - u) + best.b * (camera.cy - v);
  const double norm = m.norm();
  const double cosine = 1.0 / (norm * depth * camera.RayAtUnitDepth(u, v).norm());
  if (!(norm > 0.0) || !std::isfinite(cosine)) return;
  plane.normal_C = (-m / norm).cast<float>();
  plane.offset = static_cast<float>(1.0 / norm);
  plane.cosine = static_cast<float>(std::min(1.0, cosine));
  plane.depth = static_cast<float>(depth);
  const double along_ray = error.sigma * (averaged ? std::sqrt(best.variance) : 1.0) * depth * depth;
  plane.sigma =
      static_cast<float>(along_ray * -plane.normal_C.cast<double>().dot(camera.RayAtUnitDepth(u, v)));
}

void PixelPlanes::CompareNeighbors(const PointCloud& cloud, const DepthErrorModel& error, double tolerance) {
  one_surface_.assign(planes_.size(), 0);
  least_depths_.assign(planes_.size() * kQuadrants, 0.0F);
  const auto depth_of = [&](std::size_t pixel) {
    const float z = cloud.points_C[pixel].z();
    return std::isnan(z) || z <= 0.0F ? 0.0F : z;  // +infinity: nothing in range
  };
  // Square cells of four pixels: 0 1 / 2 3. Seen from pixel k, the others are in quadrant 3 - k.
  for (int v = 0; v + 1 < height_; ++v) {
    for (int u = 0; u + 1 < width_; ++u) {
      const auto first =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
      const std::array<std::size_t, 4> cell = {first, first + 1, first + static_cast<std::size_t>(width_),
                                               first + static_cast<std::size_t>(width_) + 1};
      float least = std::numeric_limits<float>::infinity();
      for (const std::size_t pixel : cell) least = std::min(least, depth_of(pixel));
      for (std::size_t k = 0; k < 4; ++k) {
        least_depths_[cell[k] * kQuadrants + (3 - k)] = least;
        const PixelPlane& plane = planes_[cell[k]];
        if (!plane.known()) continue;
        const auto is_on_it = [&](std::size_t pixel) {
          const PixelPlane& other = planes_[pixel];
          if (!other.known()) return false;
          const Eigen::Vector3f& p_C = cloud.points_C[pixel];
          const double noise = 3.0 * error.sigma * static_cast<double>(p_C.z() * p_C.z());
          return std::abs(static_cast<double>(plane.DistanceTo(p_C))) <= tolerance + noise;
        };
        if (std::all_of(cell.begin(), cell.end(), is_on_it)) {
          one_surface_[cell[k]] = static_cast<std::uint8_t>(one_surface_[cell[k]] | 1U << (3 - k));
        }
      }
    }
  }
}

}  // namespace thalweg::surface
