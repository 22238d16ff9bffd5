#include "services/mapper/core/depth_smoother.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/require.h"

namespace thalweg::mapper {

namespace {

constexpr double kLeastPixels = 6;    // three determine a plane, the rest test it
constexpr double kResidualLimit = 3;  // standard deviations of chi^2 above its mean
constexpr double kOwnLimit = 3;       // standard deviations of the pixel's own residual
constexpr int kParts = 3;             // the window is divided into kParts x kParts parts
constexpr double kPartsLimit = 2;     // as kResidualLimit, for the mean residuals of the parts

}  // namespace

void DepthSmoother::Sums::Add(const Sums& o, double sign) {
  n += sign * o.n;
  u += sign * o.u;
  v += sign * o.v;
  uu += sign * o.uu;
  uv += sign * o.uv;
  vv += sign * o.vv;
  w += sign * o.w;
  uw += sign * o.uw;
  vw += sign * o.vw;
  ww += sign * o.ww;
}

DepthSmoother::Sums DepthSmoother::Sums::About(double u0, double v0) const {
  Sums s = *this;
  s.u -= u0 * n;
  s.v -= v0 * n;
  s.uu -= 2 * u0 * u - u0 * u0 * n;
  s.vv -= 2 * v0 * v - v0 * v0 * n;
  s.uv -= u0 * v + v0 * u - u0 * v0 * n;
  s.uw -= u0 * w;
  s.vw -= v0 * w;
  return s;
}

DepthSmoother::DepthSmoother(const DepthErrorModel& error) : error_(error) {
  Require(std::isfinite(error.sigma) && error.sigma > 0.0, "depth_error", error.sigma, "> 0 1/m");
  Require(error.window_px > 0 && error.window_px % 2 == 1, "smooth_window", error.window_px, "odd and > 0");
  // Along one axis: variance of a fitted line's value at distance c from the middle of n pixels, beyond that
  // of their mean, for unit noise.
  const auto along = [](int n, double c) { return 12.0 * c * c / (n * (n * n - 1.0)); };
  for (int half = error.window_px / 2; half > 0; half = half > 2 ? (2 * half + 1) / 3 : half - 1) {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const Window window{i > 0 ? 0 : -half, j > 0 ? 0 : -half, i < 0 ? 0 : half, j < 0 ? 0 : half, 0.0};
        const int width = window.right - window.left + 1;
        const int height = window.bottom - window.top + 1;
        if (width * height < kLeastPixels) continue;
        windows_.push_back(window);
        windows_.back().variance = 1.0 / (width * height) + along(width, 0.5 * i * half) / height +
                                   along(height, 0.5 * j * half) / width;
      }
    }
  }
  std::ranges::stable_sort(windows_, {}, &Window::variance);
}

void DepthSmoother::Sum(int width, int height, std::span<const float> measured) {
  width_ = width;
  height_ = height;
  const std::size_t stride = static_cast<std::size_t>(width) + 1;
  sums_.assign(stride * (static_cast<std::size_t>(height) + 1), Sums{});
  std::size_t pixel = 0;
  for (int v = 0; v < height; ++v) {
    Sums row;
    for (int u = 0; u < width; ++u, ++pixel) {
      if (!std::isnan(measured[pixel])) {
        const auto w = static_cast<double>(measured[pixel]);
        row.Add({1.0, 1.0 * u, 1.0 * v, 1.0 * u * u, 1.0 * u * v, 1.0 * v * v, w, u * w, v * w, w * w}, 1.0);
      }
      const std::size_t at = (static_cast<std::size_t>(v) + 1) * stride + static_cast<std::size_t>(u) + 1;
      sums_[at] = sums_[at - stride];
      sums_[at].Add(row, 1.0);
    }
  }
}

bool DepthSmoother::Fit(const Window& window, int u, int v, float measured, std::size_t pixel) {
  const auto over = [&](int left, int top, int right, int bottom) {
    const auto clamp = [](int i, int end) { return static_cast<std::size_t>(std::clamp(i, 0, end)); };
    const std::size_t stride = static_cast<std::size_t>(width_) + 1;
    const std::size_t u0 = clamp(u + left, width_), u1 = clamp(u + right + 1, width_);
    const std::size_t v0 = clamp(v + top, height_), v1 = clamp(v + bottom + 1, height_);
    Sums sums = sums_[v1 * stride + u1];
    sums.Add(sums_[v0 * stride + u1], -1.0);
    sums.Add(sums_[v1 * stride + u0], -1.0);
    sums.Add(sums_[v0 * stride + u0], 1.0);
    return sums.About(u, v);
  };
  const Sums s = over(window.left, window.top, window.right, window.bottom);
  if (s.n < kLeastPixels) return false;
  Eigen::Matrix3d normal;
  normal << s.n, s.u, s.v, s.u, s.uu, s.uv, s.v, s.uv, s.vv;
  Eigen::Matrix3d inverse;
  bool regular = false;
  normal.computeInverseWithCheck(inverse, regular, 1e-6);
  if (!regular || inverse(0, 0) >= 1.0) return false;
  const Eigen::Vector3d right(s.w, s.uw, s.vw);
  const Eigen::Vector3d plane = inverse * right;
  const double degrees = s.n - 3.0;
  const double variance = error_.sigma * error_.sigma;
  const double squares = std::max(0.0, s.ww - plane.dot(right)) / variance;
  if (squares > degrees + kResidualLimit * std::sqrt(2.0 * degrees)) return false;
  // A depth step can hide in the sum of all residuals, but not in the mean residuals of parts of the window.
  const auto residual = [&](const Sums& part) {
    const double sum = part.w - plane.dot(Eigen::Vector3d(part.n, part.u, part.v));
    return part.n > 0.0 ? sum * sum / (part.n * variance) : 0.0;
  };
  if (residual({.n = 1.0, .w = static_cast<double>(measured)}) > kOwnLimit * kOwnLimit) return false;
  const int width = window.right - window.left + 1;
  const int height = window.bottom - window.top + 1;
  double parts = 0.0;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; j < kParts; ++j) {
      const auto edge = [](int first, int size, int k) { return first + (size * k + kParts / 2) / kParts; };
      parts += residual(over(edge(window.left, width, i), edge(window.top, height, j),
                             edge(window.left, width, i + 1) - 1, edge(window.top, height, j + 1) - 1));
    }
  }
  constexpr double kFree = kParts * kParts - 3;
  if (parts > kFree + kPartsLimit * std::sqrt(2.0 * kFree)) return false;
  if (!(plane[0] > 0.0)) return false;
  inverse_depths_[pixel] = static_cast<float>(plane[0]);
  sigmas_[pixel] = static_cast<float>(std::sqrt(variance * inverse(0, 0)));
  return true;
}

void DepthSmoother::Smooth(const PointCloud& cloud) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  measured_.clear();
  for (const Eigen::Vector3f& p_C : cloud.points_C) {
    measured_.push_back(p_C.allFinite() && p_C.z() > 0.0F ? 1.0F / p_C.z() : kNaN);
  }
  inverse_depths_ = measured_;
  sigmas_.assign(measured_.size(), static_cast<float>(error_.sigma));
  const bool organized = cloud.width_px > 0 && cloud.height_px > 0 &&
                         measured_.size() == static_cast<std::size_t>(cloud.width_px) *
                                                 static_cast<std::size_t>(cloud.height_px);
  if (!organized || windows_.empty()) return;
  Sum(cloud.width_px, cloud.height_px, measured_);
  std::size_t pixel = 0;
  for (int v = 0; v < cloud.height_px; ++v) {
    for (int u = 0; u < cloud.width_px; ++u, ++pixel) {
      if (std::isnan(measured_[pixel])) continue;
      for (const Window& window : windows_) {
        if (Fit(window, u, v, measured_[pixel], pixel)) break;
      }
    }
  }
}

}  // namespace thalweg::mapper
