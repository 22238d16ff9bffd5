#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/robot_model.h"
#include "common/voxel/dense_grid.h"
#include "common/voxel/occupancy_grid.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// What a voxel of the true world is, to a robot that starts at a given place.
enum class TrueVoxel : std::uint8_t {
  kOutside,    ///< Beyond the bounds, inside solids, or nothing the robot can ever see.
  kFree,       ///< No surface crosses it and some reachable pose sees it.
  kSurface,    ///< A surface crosses it that some reachable pose sees.
  kAmbiguous,  ///< A surface only touches its boundary: either answer is right.
};

/// The true occupancy that an exploration of this world, from this start, can find out: reachable free space
/// (where the robot's body can be, connected to the start) and all that can be seen from it within range. For
/// one that drives it is that of the layer that its body sweeps, as its camera sees it, which stays level.
class TrueMap {
 public:
  struct Options {
    double voxel_size = 0.10;  ///< [m]
    RobotModel robot = {};
    PinholeCamera camera = DepthSensorModel().camera;  ///< Matters to a robot that drives.
    double view_range = 5.0;                           ///< [m] along the ray
  };
  /// Throws std::invalid_argument when an option is not positive or the robot does not fit at the start.
  TrueMap(const World& world, const Eigen::Vector3d& start_W, const Options& options);

  const DenseGrid<TrueVoxel>& voxels() const { return voxels_; }
  /// See ReachableVoxels.
  const DenseGrid<std::uint8_t>& reachable() const { return reachable_; }
  /// Whether it is the same for a robot that starts there.
  bool HoldsFor(const Eigen::Vector3d& start_W) const;
  std::size_t observable_count() const { return observable_count_; }  ///< kFree and kSurface.
  bool Observable(const VoxelIndex& i) const {
    const TrueVoxel kind = voxels_.Get(i, TrueVoxel::kOutside);
    return kind == TrueVoxel::kFree || kind == TrueVoxel::kSurface;
  }

  struct Agreement {
    std::size_t free_right = 0, free_wrong = 0, free_unknown = 0;           ///< Of kFree.
    std::size_t surface_right = 0, surface_wrong = 0, surface_unknown = 0;  ///< Of kSurface.
    double share() const;     ///< right / all; unknown counts as wrong.
    double coverage() const;  ///< known / all.
  };
  /// Compares voxel by voxel. Throws std::invalid_argument when the map's voxels have another size.
  Agreement Compare(const OccupancyGrid& map) const;

 private:
  double voxel_size_;
  std::optional<double> plane_;  ///< [m] In which a robot drives.
  DenseGrid<TrueVoxel> voxels_;
  DenseGrid<std::uint8_t> reachable_;
  std::size_t observable_count_ = 0;
};

}  // namespace thalweg::simulator
