#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/robot_model.h"
#include "common/voxel/dense_grid.h"
#include "services/simulator/core/triangle.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// A camera that stays level and at one height, and may turn to any side and be in any voxel of one layer.
struct LevelCamera {
  double height_W = 0.0;    ///< [m] above W's origin
  int layer = 0;            ///< z of the voxels.
  double least_rise = 0.0;  ///< Of what it sees, along each metre away, seen from above; < 0: sinks.
  double greatest_rise = 0.0;

  bool Sees(const Eigen::Vector3d& position_W, const Eigen::Vector3d& target_W) const;
};
/// That of a robot that drives. @param start_W  Of its body.
LevelCamera LevelCameraOf(const RobotModel& robot, const PinholeCamera& camera,
                          const Eigen::Vector3d& start_W, double voxel_size);

/// Tells what can be seen from any of a set of positions: the centres of the voxels of `reachable`, or with a
/// level camera the points at its height above or below them.
///
/// A place is first looked at from the nearest positions, spread over directions; where none sees it, a fan
/// of rays from the place looks for a position along each, which then looks back. So a position is missed
/// only where all of them are seen through openings that fall between the fan's rays.
/// Threading: const calls from any number of threads.
class Visibility {
 public:
  /// @param level  None: the camera may look up and down as it likes.
  Visibility(const World& world, const DenseGrid<std::uint8_t>& reachable, double voxel_size,
             double view_range, const std::optional<LevelCamera>& level);

  /// Whether nothing stands between a point in the open and one of the positions, from which it is in view.
  bool SeesPoint(const Eigen::Vector3d& target) const;

  /// Whether a ray that may be looked along from one of the positions ends on one of these triangles' parts
  /// within the box.
  bool SeesSurface(const Eigen::AlignedBox3d& box, const std::vector<std::uint32_t>& triangles) const;

 private:
  std::vector<Eigen::Vector3d> NearestPositions(const Eigen::Vector3d& target) const;
  Eigen::Vector3d PositionIn(const VoxelIndex& voxel) const;
  bool InView(const Eigen::Vector3d& position, const Eigen::Vector3d& target) const;
  /// Calls sees(position) for one position a free ray of the fan passes by, until it is true.
  template <class Sees>
  bool TryFan(const Eigen::Vector3d& from, Sees&& sees) const;
  /// The same for a level camera: positions near to far along each direction, whatever stands between.
  template <class Sees>
  bool TryLevelFan(const Eigen::Vector3d& from, Sees&& sees) const;
  std::optional<Eigen::Vector3d> FirstPositionOn(const Eigen::Vector3d& from,
                                                 const Eigen::Vector3d& to) const;

  const World& world_;
  const DenseGrid<std::uint8_t>& reachable_;
  double voxel_size_;
  double view_range_;
  std::optional<LevelCamera> level_;
  std::vector<VoxelIndex> near_offsets_;  ///< By distance.
  std::vector<Eigen::Vector3d> fan_;
};

}  // namespace thalweg::simulator
