#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/map_model.h"
#include "common/geometry/robot_model.h"
#include "common/voxel/dense_grid.h"
#include "common/voxel/occupancy_grid.h"
#include "services/simulator/core/visibility.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// What a voxel of the true world is to a robot that starts at a given position.
enum class TrueVoxel : std::uint8_t {
  kOutside,    ///< Beyond the bounds, inside a solid, or not visible from any reachable pose.
  kFree,       ///< No surface crosses it, and some reachable pose sees it.
  kSurface,    ///< A surface that some reachable pose sees crosses it.
  kAmbiguous,  ///< A surface only touches its boundary, or a part sweeps it: either answer is right.
};

/// Ground-truth occupancy, limited to what an exploration from a given start can observe: the reachable free
/// space (positions of the robot's body that are connected to the start) and everything visible from it
/// within range. For a robot that stays level, visible is what its camera sees meanwhile, at any pitch of its
/// gimbal if it has one; for one that drives, reachable space is the layer that its body sweeps. A level
/// robot that flies is taken to reach whatever it fits into, also upward through a shaft of which its camera
/// sees nothing: an upper bound. Parts that move are taken to stand in no way and to hide nothing, as if each
/// were out of the way at some time: an upper bound as well. What they sweep at any time is ambiguous.
class TrueMap {
 public:
  struct Options {
    double voxel_size = MapModel{}.voxel_size;  ///< [m]
    RobotModel robot = {};
    PinholeCamera camera = DepthSensorModel().camera;  ///< Not used for a robot that turns freely.
    double view_range = MapModel{}.max_range;          ///< [m] along the ray.
  };
  /// The camera of a robot that starts there; empty: it may look up and down freely.
  static std::optional<LevelCamera> CameraOf(const Options& options, const Eigen::Vector3d& start_W);

  /// Throws std::invalid_argument when an option is not positive or the robot does not fit at the start.
  TrueMap(const World& world, const Eigen::Vector3d& start_W, const Options& options);

  const DenseGrid<TrueVoxel>& voxels() const { return voxels_; }
  /// See ReachableVoxels.
  const DenseGrid<std::uint8_t>& reachable() const { return reachable_; }
  /// Whether the same truth holds for a robot that starts at `start_W`.
  bool HoldsFor(const Eigen::Vector3d& start_W) const;
  /// Number of kFree and kSurface voxels.
  std::size_t observable_count() const { return observable_count_; }
  bool Observable(const VoxelIndex& i) const {
    const TrueVoxel kind = voxels_.Get(i, TrueVoxel::kOutside);
    return kind == TrueVoxel::kFree || kind == TrueVoxel::kSurface;
  }

  struct Agreement {
    std::size_t free_right = 0, free_wrong = 0, free_unknown = 0;           ///< The kFree voxels.
    std::size_t surface_right = 0, surface_wrong = 0, surface_unknown = 0;  ///< The kSurface voxels.
    double share() const;     ///< right / all; unknown counts as wrong.
    double coverage() const;  ///< known / all.
  };
  /// Compares voxel by voxel. Throws std::invalid_argument when the voxel sizes differ.
  Agreement Compare(const OccupancyGrid& map) const;

 private:
  double voxel_size_;
  std::optional<double> plane_;  ///< [m] z of the plane in which a robot drives.
  DenseGrid<TrueVoxel> voxels_;
  DenseGrid<std::uint8_t> reachable_;
  std::size_t observable_count_ = 0;
};

}  // namespace thalweg::simulator
