#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "common/voxel/dense_grid.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::explorer {

/// The known world as the planner needs it: a dense grid of voxel states with, kept up to date voxel by
/// voxel, where the robot's sphere fits.
///
/// A voxel is traversable when it is free, within the bounds, and the sphere of `clearance` about its centre
/// touches no voxel that is occupied or unknown. So the robot never enters what it has not seen.
/// Threading: one thread owns a map.
class PlanningMap {
 public:
  struct Options {
    double voxel_size = 0.10;                   ///< [m]
    double clearance = 0.15;                    ///< [m] Robot's radius and margin.
    std::optional<Eigen::AlignedBox3d> bounds;  ///< [m] Absent: the map grows with what is known,
    std::size_t max_voxels = 50'000'000;        ///< up to a box of so many.
    std::vector<Eigen::AlignedBox3d> no_go =
        {};  ///< [m] The robot keeps out of them; nothing there is asked for.
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit PlanningMap(const Options& options);

  /// Takes new values; those beyond the bounds, or too far for max_voxels, are ignored.
  /// @return voxels whose state changed, each with its former state; valid until the next call.
  struct StateChange {
    VoxelIndex voxel;
    VoxelState before;
    VoxelState now;
  };
  std::span<const StateChange> Apply(std::span<const VoxelChange> changes);
  /// Back to knowing nothing.
  void Reset();

  std::size_t beyond_limit() const { return beyond_limit_; }  ///< Values too far for max_voxels.

  const Options& options() const { return options_; }
  double voxel_size() const { return options_.voxel_size; }
  /// All that is known lies inside, every free voxel of the bounds and every traversable one at least one
  /// voxel off the box's faces: their neighbours are inside.
  const VoxelBox& box() const { return states_.box(); }
  const DenseGrid<VoxelState>& states() const { return states_; }
  VoxelState State(const VoxelIndex& i) const { return states_.Get(i, VoxelState::kUnknown); }
  VoxelIndex IndexOf(const Eigen::Vector3d& p_W) const { return VoxelAt(p_W, voxel_size()); }
  Eigen::Vector3d CenterOf(const VoxelIndex& i) const { return VoxelCenter(i, voxel_size()); }
  /// Whether exploration is asked for here at all.
  bool InBounds(const VoxelIndex& i) const { return bounds_.Contains(i) && !NoGo(i); }
  /// Whether a part of it lies in a no-go box: an obstacle to the body, though not to the eye.
  bool NoGo(const VoxelIndex& i) const { return !no_go_.empty() && NoGoAmong(i); }

  bool Traversable(const VoxelIndex& i) const {
    return states_.Contains(i) && Traversable(states_.Offset(i));
  }
  bool Traversable(std::size_t offset) const { return blockers_[offset] == 0; }
  std::size_t traversable_count() const { return traversable_count_; }

  enum class Obstacles : std::uint8_t { kOccupied, kOccupiedAndUnknown };
  /// [m] from a point to the nearest obstacle voxel's cube, or `limit` when none is nearer.
  /// O((limit/size)^3).
  double ClearanceAt(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit) const;
  /// Whether a sphere of radius `clearance` moves from a to b without touching an obstacle voxel.
  bool SegmentClear(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                    double clearance) const;
  /// The least clearance on the way from a to b, or `limit` when it is nowhere less; to within a sixteenth of
  /// a voxel.
  double SegmentClearance(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                          double limit) const;
  /// Whether the voxels between the two, both ends aside, are all free: b is in plain sight from a.
  bool InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

 private:
  bool NoGoAmong(const VoxelIndex& i) const;
  void SetState(const VoxelIndex& i, VoxelState now);
  bool Grow(const VoxelIndex& include);
  void Rebuild(const VoxelBox& box);
  void Block(const VoxelIndex& i, int by);

  Options options_;
  VoxelBox bounds_;                   ///< Where exploration is asked for.
  std::vector<VoxelBox> no_go_;       ///< But not there.
  int reach_ = 0;                     ///< Of the clearance, in voxels.
  std::vector<VoxelIndex> blocking_;  ///< Offsets of the voxels that a voxel at 0 blocks, itself included.
  DenseGrid<VoxelState> states_;
  DenseGrid<std::uint16_t>
      blockers_;  ///< Occupied and unknown voxels within clearance, itself included; out of bounds adds one.
  std::size_t traversable_count_ = 0;
  std::size_t beyond_limit_ = 0;
  std::vector<StateChange> changes_;
};

}  // namespace thalweg::explorer
