#include "tests/services/visual_odometry/support/textured_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace thalweg::visual_odometry::test {
namespace {

const Eigen::Vector3d kSize(6.0, 5.0, 3.0);

double Lattice(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^
                    static_cast<std::uint64_t>(z) * 0x165667B19E3779F9ULL;
  h ^= h >> 29U;
  h *= 0xBF58476D1CE4E5B9ULL;
  h ^= h >> 32U;
  return static_cast<double>(h & 0xFFFFU) / 32767.5 - 1.0;
}

double Noise(const Eigen::Vector3d& p) {
  std::array<std::int64_t, 3> cell{};
  Eigen::Vector3d s;
  for (int k = 0; k < 3; ++k) {
    const double low = std::floor(p[k]);
    cell[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(low);
    const double t = p[k] - low;
    s[k] = t * t * (3.0 - 2.0 * t);
  }
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1;
    const int y = (corner >> 1) & 1;
    const int z = corner >> 2;
    sum += (x != 0 ? s.x() : 1.0 - s.x()) * (y != 0 ? s.y() : 1.0 - s.y()) * (z != 0 ? s.z() : 1.0 - s.z()) *
           Lattice(cell[0] + x, cell[1] + y, cell[2] + z);
  }
  return sum;
}

/// Point where a ray from inside the box leaves it.
Eigen::Vector3d Wall(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (ray[k] == 0.0) continue;
    const double wall = ray[k] > 0.0 ? kSize[k] : 0.0;
    nearest = std::min(nearest, (wall - origin[k]) / ray[k]);
  }
  return origin + nearest * ray;
}

}  // namespace

cv::Mat TexturedRoom::See(const PinholeCamera& camera, const RigidTransform& T_WC, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  cv::Mat image(camera.height_px, camera.width_px, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      Eigen::Vector3d p = Wall(T_WC.translation(), T_WC.linear() * camera.RayAtUnitDepth(u, v));
      if (period_ > 0.0) p.x() = std::fmod(p.x(), period_);
      const double pattern = 0.6 * Noise(p / 0.11 + Eigen::Vector3d(0.3, 0.7, 0.5)) +
                             0.5 * Noise(p / 0.31 + Eigen::Vector3d(0.1, 0.2, 0.9));
      const double value = 130.0 + contrast_ * 90.0 * pattern + noise_ * noise(random);
      image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  }
  return image;
}

StereoImages TexturedRoom::SeePair(const StereoGeometry& rig, const RigidTransform& T_WC, Time stamp) const {
  RigidTransform T_WR = T_WC;
  T_WR.translation() += rig.baseline * T_WC.linear().col(0);
  const auto seed = static_cast<std::uint64_t>(stamp.time_since_epoch().count());
  return {stamp, See(rig.camera, T_WC, 2 * seed), See(rig.camera, T_WR, 2 * seed + 1)};
}

StereoGeometry SmallRig() {
  return {PinholeCamera::FromFieldOfView(320, 240, 1.2217304763960306), 0.12};
}

RigidTransform RoomPose(int step) {
  return MakeTransform(RotationFromYawPitch(0.01 * step, 0.004 * step) * BodyFromOptical(),
                       Eigen::Vector3d(2.0 + 0.025 * step, 2.5 + 0.006 * step, 1.4));
}

Time RoomStamp(int step) {
  return Time(std::chrono::seconds(1)) + step * std::chrono::milliseconds(50);
}

}  // namespace thalweg::visual_odometry::test
