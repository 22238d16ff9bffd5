#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::test {

/// A room with boxes in it, whose ranges are known in closed form.
struct AnalyticRoom {
  Eigen::AlignedBox3d walls;               ///< Seen from inside.
  std::vector<Eigen::AlignedBox3d> boxes;  ///< Seen from outside.

  /// 8 x 6 x 3 m, furnished, with walls not aligned with any voxel grid.
  static AnalyticRoom Furnished() {
    using Box = Eigen::AlignedBox3d;
    using Point = Eigen::Vector3d;
    return {Box(Point(-4.013, -3.027, -1.041), Point(3.987, 2.973, 1.959)),
            {Box(Point(1.021, -0.513, -1.041), Point(1.837, 1.264, -0.317)),     // table block
             Box(Point(-3.921, 1.718, -1.041), Point(-2.133, 2.917, 0.846)),     // cupboard
             Box(Point(2.213, -2.962, -1.041), Point(2.689, -2.287, 1.113)),     // shelf
             Box(Point(-1.483, -2.139, -1.041), Point(-0.921, -1.577, -0.538)),  // crate
             Box(Point(-0.317, 0.921, 0.663), Point(0.118, 1.358, 1.217))}};     // lamp
  }

  /// Distance along the ray to the first surface.
  /// @param direction_W  Unit length.
  double CastRay(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W) const {
    double nearest = Slabs(walls, origin_W, direction_W).second;
    for (const Eigen::AlignedBox3d& box : boxes) {
      const auto [enter, leave] = Slabs(box, origin_W, direction_W);
      if (enter <= leave && enter > 0.0) nearest = std::min(nearest, enter);
    }
    return nearest;
  }

  /// Renders what a depth camera sees; NaN beyond `max_range` along the ray.
  PointCloud Render(const PinholeCamera& camera, const RigidTransform& T_WC,
                    double max_range = std::numeric_limits<double>::infinity()) const {
    PointCloud cloud{
        .width_px = camera.width_px, .height_px = camera.height_px, .points_C = {}, .colors = {}};
    for (int v = 0; v < camera.height_px; ++v) {
      for (int u = 0; u < camera.width_px; ++u) {
        const Eigen::Vector3d ray_C = camera.RayAtUnitDepth(u, v).normalized();
        const double range = CastRay(T_WC.translation(), T_WC.linear() * ray_C);
        const bool seen = range <= max_range;
        cloud.points_C.push_back(seen ? (range * ray_C).cast<float>().eval()
                                      : Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
      }
    }
    return cloud;
  }

  /// A random camera pose in the room's free space, looking at most 0.6 rad above or below the horizon.
  RigidTransform RandomPose(std::mt19937& random) const {
    std::uniform_real_distribution<double> share(0.05, 0.95);
    std::uniform_real_distribution<double> yaw(-3.14159, 3.14159);
    std::uniform_real_distribution<double> pitch(-0.6, 0.6);
    for (;;) {
      Eigen::Vector3d shares;  // one after the other, since compilers evaluate arguments in any order
      for (const int axis : {2, 1, 0}) shares[axis] = share(random);
      const Eigen::Vector3d p_W = walls.min() + shares.cwiseProduct(walls.sizes());
      bool free = true;
      for (const Eigen::AlignedBox3d& box : boxes) free = free && !box.contains(p_W);
      if (!free) continue;
      const double up = pitch(random);
      return MakeTransform(RotationFromYawPitch(yaw(random), up) * BodyFromOptical(), p_W);
    }
  }

 private:
  /// Distances at which the ray enters and leaves the box.
  static std::pair<double, double> Slabs(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin_W,
                                         const Eigen::Vector3d& direction_W) {
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double inverse = 1.0 / direction_W[axis];
      const double a = (box.min()[axis] - origin_W[axis]) * inverse;
      const double b = (box.max()[axis] - origin_W[axis]) * inverse;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return {enter, leave};
  }
};

}  // namespace thalweg::test
