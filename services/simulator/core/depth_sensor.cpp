#include "services/simulator/core/depth_sensor.h"

#include <limits>

namespace thalweg::simulator {

DepthSensor::DepthSensor(const DepthSensorModel& model, std::uint32_t noise_seed, bool colors)
    : model_(model), random_(noise_seed), colors_(colors) {}

PointCloud DepthSensor::Capture(const World& world, const RigidTransform& T_WC) {
  const PinholeCamera& camera = model_.camera;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  PointCloud cloud;
  cloud.width_px = camera.width_px;
  cloud.height_px = camera.height_px;
  const auto count = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  cloud.points_C.assign(count, Eigen::Vector3f::Constant(kNaN));
  if (colors_) cloud.colors.assign(count, Rgb{});
  std::normal_distribution<double> noise(0.0, 1.0);
  std::size_t pixel = 0;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u, ++pixel) {
      const Eigen::Vector3d ray_C = camera.RayAtUnitDepth(u, v);
      const double length = ray_C.norm();
      const auto hit = world.CastRay(T_WC.translation(), T_WC.linear() * (ray_C / length), model_.max_range);
      if (!hit) {
        if (model_.no_return_is_free) cloud.points_C[pixel] = NoReturn();
        continue;
      }
      double depth = hit->distance / length;
      if (colors_) cloud.colors[pixel] = world.ColorAt(*hit, depth / camera.fx);
      double disparity_error = 0.0;
      Eigen::Vector3d seen_C = ray_C;
      if (model_.disparity_noise_px > 0.0) disparity_error = model_.disparity_noise_px * noise(random_);
      if (model_.image_noise_px > 0.0) {
        const double columns = model_.image_noise_px * noise(random_);
        const double rows = model_.image_noise_px * noise(random_);
        seen_C = camera.RayAtUnitDepth(u + columns, v + rows);
        disparity_error += columns;
      }
      if (disparity_error != 0.0) {
        const double focal_baseline = camera.fx * model_.baseline;
        const double disparity = focal_baseline / depth + disparity_error;
        if (disparity <= 0.0) continue;
        depth = focal_baseline / disparity;
      }
      cloud.points_C[pixel] = (seen_C * depth).cast<float>();
    }
  }
  return cloud;
}

}  // namespace thalweg::simulator
