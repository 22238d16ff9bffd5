#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/robot_model.h"
#include "common/geometry/triangle.h"
#include "common/voxel/dense_grid.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// A camera on a body that stays level and may turn to any heading, perhaps on a gimbal that pitches.
struct LevelCamera {
  double above_body = 0.0;        ///< [m] Height above the body's center.
  std::optional<double> plane_W;  ///< [m] z of the body's center, if it drives.
  double least_rise = 0.0;        ///< Slope of the lowest ray in view [m/m over ground]; < 0: downward.
  double greatest_rise = 0.0;

  /// Where the camera is when the body's center is at `p_W`.
  Eigen::Vector3d EyeOf(const Eigen::Vector3d& p_W) const {
    return {p_W.x(), p_W.y(), plane_W.value_or(p_W.z()) + above_body};
  }
  bool Sees(const Eigen::Vector3d& position_W, const Eigen::Vector3d& target_W) const;
};
/// The camera of a robot that stays level. @param start_W  Start position of its body.
LevelCamera LevelCameraOf(const RobotModel& robot, const PinholeCamera& camera,
                          const Eigen::Vector3d& start_W);

/// The part of a triangle inside a voxel.
struct SurfacePatch {
  std::vector<Eigen::Vector3d> aims;  ///< [m] Points on it to look at; the first is its center.
  Eigen::Vector3d normal;
  double area = 0.0;  ///< [m^2]
};
/// The parts of triangles inside a box that are looked at to decide whether it is seen: the largest ones.
std::vector<SurfacePatch> PatchesIn(const Eigen::AlignedBox3d& box, const Mesh& mesh,
                                    const std::vector<std::uint32_t>& triangles);

/// Whether the segment from an eye to an aim on a surface inside the box ends in the box, on either side of
/// the surface. @param view_range  [m] No longer segment counts.
bool SeesAim(const World& world, const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye_W,
             const Eigen::Vector3d& aim_W, double view_range);

/// Determines what can be seen from any of a set of positions: the centers of the voxels flagged in
/// `reachable` or, for a level camera, the points as far above these centers as it is above the body's, whose
/// height is that of the plane if it drives.
///
/// A target is first tested from the nearest positions, spread over directions. If none sees it, a fan of
/// rays from the target looks for a position along each ray, from which the target is then tested. A visible
/// target is therefore missed only if every position sees it through openings that fall between the rays of
/// the fan.
/// Threading: const calls from any number of threads.
class Visibility {
 public:
  /// @param level  Empty: the camera may look up and down freely.
  Visibility(const World& world, const DenseGrid<std::uint8_t>& reachable, double voxel_size,
             double view_range, const std::optional<LevelCamera>& level);

  /// Whether a free point is in view of one of the positions, with nothing in between.
  bool SeesPoint(const Eigen::Vector3d& target) const;

  /// Whether one of the positions has an admissible line of sight that ends on the part of one of these
  /// triangles inside the box.
  bool SeesSurface(const Eigen::AlignedBox3d& box, const std::vector<std::uint32_t>& triangles) const;

 private:
  std::vector<Eigen::Vector3d> NearestPositions(const Eigen::Vector3d& target) const;
  Eigen::Vector3d PositionIn(const VoxelIndex& voxel) const;
  bool InView(const Eigen::Vector3d& position, const Eigen::Vector3d& target) const;
  /// Calls sees(position) for one position along each free ray of the fan until it returns true.
  template <class Sees>
  bool TryFan(const Eigen::Vector3d& from, Sees&& sees) const;
  /// As TryFan, for a level camera in a plane: tries positions from near to far along each direction,
  /// whatever lies between.
  template <class Sees>
  bool TryFanInPlane(const Eigen::Vector3d& from, Sees&& sees) const;
  /// The first position on a line that has its beginning in view.
  std::optional<Eigen::Vector3d> FirstPositionOn(const Eigen::Vector3d& from,
                                                 const Eigen::Vector3d& to) const;

  const World& world_;
  const DenseGrid<std::uint8_t>& reachable_;
  double voxel_size_;
  double view_range_;
  std::optional<LevelCamera> level_;
  std::vector<VoxelIndex> near_offsets_;  ///< Sorted by distance.
  std::vector<Eigen::Vector3d> fan_;
};

}  // namespace thalweg::simulator
