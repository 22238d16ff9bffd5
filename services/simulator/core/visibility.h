#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/voxel/dense_grid.h"
#include "services/simulator/core/triangle.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// Tells what can be seen from any of a set of positions: the centres of the voxels of `reachable`.
///
/// A place is first looked at from the nearest positions, spread over directions; where none sees it, a fan
/// of rays from the place looks for a position along each, which then looks back. So a position is missed
/// only where all of them are seen through openings that fall between the fan's rays.
/// Threading: const calls from any number of threads.
class Visibility {
 public:
  Visibility(const World& world, const DenseGrid<std::uint8_t>& reachable, double voxel_size,
             double view_range);

  /// Whether nothing stands between a point in the open and one of the positions.
  bool SeesPoint(const Eigen::Vector3d& target) const;

  /// Whether a ray from one of the positions ends on one of these triangles' parts within the box.
  bool SeesSurface(const Eigen::AlignedBox3d& box, const std::vector<std::uint32_t>& triangles) const;

 private:
  std::vector<Eigen::Vector3d> NearestPositions(const Eigen::Vector3d& target) const;
  /// Calls sees(position) for one position a free ray of the fan passes by, until it is true.
  template <class Sees>
  bool TryFan(const Eigen::Vector3d& from, Sees&& sees) const;
  std::optional<Eigen::Vector3d> FirstPositionOn(const Eigen::Vector3d& from,
                                                 const Eigen::Vector3d& to) const;

  const World& world_;
  const DenseGrid<std::uint8_t>& reachable_;
  double voxel_size_;
  double view_range_;
  std::vector<VoxelIndex> near_offsets_;  ///< By distance.
  std::vector<Eigen::Vector3d> fan_;
};

}  // namespace thalweg::simulator
