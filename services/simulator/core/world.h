#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/robot_model.h"
#include "services/simulator/core/mesh.h"

namespace thalweg::simulator {

/// The point where a ray hits a surface.
struct Hit {
  double distance = 0.0;     ///< [m] along the ray.
  Eigen::Vector3d normal_W;  ///< Unit length, facing the ray's origin.
  std::uint32_t triangle = 0;
  Eigen::Vector2d barycentric;  ///< Weights of the triangle's corners 1 and 2.
};

/// The true world: a triangle mesh that answers geometric queries through Embree [Wald et al.: Embree, ACM
/// TOG 33(4), 2014]. Threading: const calls from any number of threads.
class World {
 public:
  /// @param bounds_W  Box [m] within which the world is explored and maps are evaluated.
  /// @param no_go_W   Boxes [m] that are excluded, and that no part of the robot may enter.
  /// Throws std::invalid_argument when the mesh has no triangles, a triangle refers to a missing vertex, or
  /// the bounds are empty.
  World(Mesh mesh, const Eigen::AlignedBox3d& bounds_W, std::vector<Eigen::AlignedBox3d> no_go_W = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  const Mesh& mesh() const;
  const Eigen::AlignedBox3d& bounds() const;
  const std::vector<Eigen::AlignedBox3d>& no_go() const;

  /// First surface along a ray; either side of a triangle stops it. @param direction_W  Unit length.
  std::optional<Hit> CastRay(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W,
                             double max_distance) const;

  /// [m] Distance to the nearest surface, or `max_distance` when none is nearer.
  double DistanceToSurface(const Eigen::Vector3d& p_W, double max_distance) const;

  /// [m] Distance from the body of a robot at `p_W` to the nearest surface, or `limit` when none is nearer;
  /// negative when a surface is inside the body. It changes by no more than the body moves. For a body with a
  /// height it is the distance defined at UprightCylinder, too small by at most 0.1 um.
  double ClearanceOf(const RobotModel& robot, const Eigen::Vector3d& p_W, double limit) const;

  /// Whether the segment between the two points meets no surface.
  bool InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

  /// Color of the surface, before lighting: that of its texture, its material, or a procedural pattern, so
  /// that no surface is blank to stereo matching.
  /// @param footprint  [m] Size of the area seen, e.g. that of a pixel on the surface; 0 = a point.
  Rgb ColorAt(const Hit& hit, double footprint = 0.0) const;
  /// Whether the surface has an image texture.
  bool HasTexture(const Hit& hit) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thalweg::simulator
