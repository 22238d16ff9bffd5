#include "services/mapper/core/surface_fill.h"

#include <cmath>
#include <limits>

namespace thalweg::mapper {

namespace {

/// 1 / z; NaN outside the image and where nothing was measured.
float InverseDepth(const PointCloud& cloud, int u, int v) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  if (u < 0 || v < 0 || u >= cloud.width_px || v >= cloud.height_px) return kNone;
  const Eigen::Vector3f& p_C = cloud.points_C[static_cast<std::size_t>(v * cloud.width_px + u)];
  return p_C.allFinite() && p_C.z() > 0.0F ? 1.0F / p_C.z() : kNone;
}

}  // namespace

bool SurfaceFill::OnOnePlane(const PointCloud& cloud, int u, int v, int du, int dv) const {
  const auto at = [&cloud](int pu, int pv) -> const Eigen::Vector3f& {
    return cloud.points_C[static_cast<std::size_t>(pv * cloud.width_px + pu)];
  };
  const auto gap = static_cast<double>((at(u + du, v + dv) - at(u, v)).norm());
  if (!(gap >= options_.min_gap && gap <= options_.max_gap)) return false;
  const float q_a = InverseDepth(cloud, u, v);
  const float q_b = InverseDepth(cloud, u + du, v + dv);
  const float q_before = InverseDepth(cloud, u - du, v - dv);
  const float q_after = InverseDepth(cloud, u + 2 * du, v + 2 * dv);
  const auto limit = static_cast<float>(options_.tolerance);
  // Comparisons with NaN are false, so that a side without a measurement supports no plane.
  return std::abs(q_before - 2.0F * q_a + q_b) <= limit * q_a ||
         std::abs(q_a - 2.0F * q_b + q_after) <= limit * q_b;
}

}  // namespace thalweg::mapper
