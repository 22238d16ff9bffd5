#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/robot_model.h"
#include "services/simulator/core/mesh.h"
#include "services/simulator/core/moving_part.h"

namespace thalweg::simulator {

/// The point where a ray hits a surface.
struct Hit {
  double distance = 0.0;     ///< [m] along the ray.
  Eigen::Vector3d normal_W;  ///< Unit length, facing the ray's origin.
  /// On a part that moves: where this point is when the part is at rest.
  std::optional<Eigen::Vector3d> at_rest_W = {};
  std::uint32_t triangle = 0;   ///< Index in the mesh; only where at_rest_W is empty.
  Eigen::Vector2d barycentric;  ///< Weights of the triangle's corners 1 and 2.
};

/// The true world: a triangle mesh that answers geometric queries through Embree [Wald et al.: Embree, ACM
/// TOG 33(4), 2014], and boxes in it that move, which every query sees where they are now. They are few, and
/// a box has closed forms, so that the mesh needs not be committed again at each of their steps, and nothing
/// changes for a world without any.
/// Threading: const calls from any number of threads, but not while MoveParts runs.
class World {
 public:
  /// @param bounds_W  Box [m] within which the world is explored and maps are evaluated.
  /// @param no_go_W   Boxes [m] that are excluded, and that no part of the robot may enter.
  /// @param parts     Boxes that move; their clocks begin at 0.
  /// Throws std::invalid_argument when the mesh has no triangles, a triangle refers to a missing vertex, or
  /// the bounds are empty.
  World(Mesh mesh, const Eigen::AlignedBox3d& bounds_W, std::vector<Eigen::AlignedBox3d> no_go_W = {},
        std::vector<MovingPart> parts = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  const Mesh& mesh() const;
  const Eigen::AlignedBox3d& bounds() const;
  const std::vector<Eigen::AlignedBox3d>& no_go() const;
  const std::vector<PartInMotion>& parts() const;

  /// A copy without the parts that move.
  World WithoutParts() const;
  /// A copy of its own for one run: its parts are where their timetables begin.
  World AtStart() const;

  /// Lets `dt` seconds pass for all parts, with the robot at `p_W`, which they do not run into.
  /// @return [m] No point of them has moved by more; no clearance has shrunk by more.
  double MoveParts(double dt, const RobotModel& robot, const Eigen::Vector3d& p_W);

  /// First surface along a ray; either side of a triangle stops it. @param direction_W  Unit length.
  std::optional<Hit> CastRay(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W,
                             double max_distance) const;

  /// [m] Distance to the nearest surface, or `max_distance` when none is nearer; 0 inside a part that moves.
  double DistanceToSurface(const Eigen::Vector3d& p_W, double max_distance) const;

  /// [m] Distance from the body of a robot at `p_W` to the nearest surface, or `limit` when none is nearer;
  /// negative when a surface is inside the body. It changes by no more than the body moves. For a body with a
  /// height it is the distance defined at UprightCylinder, too small by at most 0.1 um.
  double ClearanceOf(const RobotModel& robot, const Eigen::Vector3d& p_W, double limit) const;

  /// Whether the segment between the two points meets no surface.
  bool InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

  /// Color of the surface, before lighting: that of its texture, its material, or a procedural pattern, so
  /// that no surface is blank to stereo matching. The pattern travels along with a part that moves.
  /// @param footprint  [m] Size of the area seen, e.g. that of a pixel on the surface; 0 = a point.
  Rgb ColorAt(const Hit& hit, double footprint = 0.0) const;
  /// Whether the surface has an image texture.
  bool HasTexture(const Hit& hit) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thalweg::simulator
