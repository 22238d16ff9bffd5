#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/robot_model.h"
#include "services/simulator/core/mesh.h"

namespace thalweg::simulator {

/// Where a ray met a surface.
struct Hit {
  double distance = 0.0;     ///< [m] along the ray.
  Eigen::Vector3d normal_W;  ///< Unit length, turned towards the ray's origin.
  std::uint32_t triangle = 0;
  Eigen::Vector2d barycentric;  ///< Weights of the triangle's corners 1 and 2.
};

/// The true world: a mesh that answers geometric questions, through Embree [Wald et al.: Embree, ACM TOG
/// 33(4), 2014]. Threading: const calls from any number of threads.
class World {
 public:
  /// @param bounds_W  Box [m] within which the world is explored and judged,
  /// @param no_go_W   apart from these [m], in which no part of the robot may be.
  /// Throws std::invalid_argument when the mesh has no triangles, one names a vertex that is not there, or
  /// the box is empty.
  World(Mesh mesh, const Eigen::AlignedBox3d& bounds_W, std::vector<Eigen::AlignedBox3d> no_go_W = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  const Mesh& mesh() const;
  const Eigen::AlignedBox3d& bounds() const;
  const std::vector<Eigen::AlignedBox3d>& no_go() const;

  /// First surface along a ray. @param direction_W  Unit length. Either side of a triangle stops it.
  std::optional<Hit> CastRay(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W,
                             double max_distance) const;

  /// [m] to the nearest surface, or `max_distance` when none is nearer.
  double DistanceToSurface(const Eigen::Vector3d& p_W, double max_distance) const;

  /// [m] From the robot's body, its origin there, to the nearest surface, or `limit` when none is nearer:
  /// negative when one is within it. Changes by no more than the body moves. For a cylinder as defined at
  /// UprightCylinder, and at most 0.1 um too little.
  double ClearanceOf(const RobotModel& robot, const Eigen::Vector3d& p_W, double limit) const;

  /// Whether nothing stands between the two points.
  bool InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

  /// Colour of the surface there, before light: its texture, its material, or a procedural pattern so that no
  /// surface is blank.
  /// @param footprint  [m] Size on the surface of what looks, e.g. of a pixel; 0 = a point.
  Rgb ColorAt(const Hit& hit, double footprint = 0.0) const;
  /// Whether an image lies over the surface there.
  bool HasTexture(const Hit& hit) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thalweg::simulator
