#pragma once

#include <cstddef>
#include <optional>
#include <unordered_set>

#include "common/voxel/occupancy_grid.h"
#include "services/controller/core/track.h"

namespace thalweg::controller {

/// Checks a track against a map: whether the robot's body, moving along it, would touch a voxel that is known
/// to be occupied. What is unknown counts as free, since the explorer has its reasons to go there. What the
/// body touches where it is does not count either: it is noise, or there is no help for it.
///
/// The body is a sphere, or an upright cylinder, at samples a quarter of a voxel apart, against whole voxels;
/// if it drives, against those whose centers lie within its height, as in the explorer's plans. The work is
/// spread over time: each call looks at no more than about kBudget voxels. The robot may go as far as
/// clear_to(), and a check that has found nothing begins again as soon as the map has changed.
///
/// Threading: one thread.
class PathCheck {
 public:
  struct Body {
    double radius = RobotModel{}.radius;  ///< [m]
    double height = RobotModel{}.height;  ///< [m] Height of the cylinder; 0 = a sphere.
    bool drives = RobotModel{}.drives;    ///< Stands on the floor, whose voxels may reach into its height.
  };
  static constexpr std::size_t kBudget = 50'000;

  explicit PathCheck(const Body& body) : body_(body) {}

  /// Begins the check of a track, or begins it again because the map has changed, from arc length `s` on.
  void Restart(const OccupancyGrid& map, const Track& track, double s);
  /// Continues it.
  void Continue(const OccupancyGrid& map, const Track& track);

  double clear_to() const { return clear_to_; }  ///< [m] Arc length up to which nothing is in the way.
  /// Center of the first voxel on the track that is in the way, if the check has found one.
  const std::optional<Eigen::Vector3d>& obstacle_W() const { return obstacle_W_; }

 private:
  /// Calls visit(VoxelIndex) for the occupied voxels that the body touches at p_W, until it returns false.
  /// @return The number of voxels looked at.
  template <class Visitor>
  std::size_t ForEachTouched(const OccupancyGrid& map, const Eigen::Vector3d& p_W, Visitor&& visit) const;

  Body body_;
  double clear_to_ = 0.0;
  std::optional<Eigen::Vector3d> obstacle_W_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> touched_at_start_;
};

}  // namespace thalweg::controller
