#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/map_model.h"
#include "common/geometry/robot_model.h"
#include "common/voxel/dense_grid.h"
#include "common/voxel/occupancy_grid.h"
#include "common/voxel/voxels_within.h"

namespace thalweg::explorer {

/// Which known voxels are so uncertain that they become targets again, at a lower value than unknown ones.
struct DoubtOptions {
  double max_log_odds = 0.0;  ///< A known voxel with |log odds| below this is doubtful; 0 = none is.
  double weight = 0.5;        ///< Value of a doubtful voxel relative to an unknown one, in (0, 1].
};

/// Log odds of a voxel that is free whatever was measured.
inline constexpr float kSurelyFree = -std::numeric_limits<float>::infinity();

/// The known world as the planner needs it: a dense grid of voxel states and of where the robot's body fits,
/// updated voxel by voxel.
///
/// A voxel is traversable when it is free, within the bounds, and the body centered in it touches no occupied
/// or unknown voxel, so the robot never enters space that it has not seen. The body is a sphere of radius
/// `clearance` or an upright cylinder, which collides with whatever is nearer to its axis than `clearance`
/// and less than half_height above or below its center.
///
/// With a plane, the robot drives. The map is then the band of heights that its cylinder sweeps: nothing else
/// is explored, and only voxels of the plane's layer are traversable. Paths are planar, and an obstacle
/// anywhere in the band blocks them. A camera above or below the band looks through the space in between.
/// Threading: one thread owns a map.
class PlanningMap {
 public:
  struct Options {
    double voxel_size = MapModel{}.voxel_size;  ///< [m]
    double clearance = RobotModel{}.radius;     ///< [m] Robot's radius and margin.
    double half_height = 0.0;  ///< [m] Half the height of the upright cylinder; 0 = a sphere.
    std::optional<Eigen::AlignedBox3d> bounds;  ///< [m] Absent: the map grows with what is known,
    std::size_t max_voxels = 50'000'000;        ///< up to a box of so many.
    std::vector<Eigen::AlignedBox3d> no_go =
        {};                      ///< [m] The robot keeps out of them; nothing there is asked for.
    double camera_height = 0.0;  ///< [m] Height of the camera above the center of a level body.
    DoubtOptions doubt = {};
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit PlanningMap(const Options& options);

  /// A voxel whose state or doubtfulness changed.
  struct StateChange {
    VoxelIndex voxel;
    VoxelState before;
    VoxelState now;
    bool doubtful_before = false;
    bool doubtful_now = false;
  };
  /// Applies new values. Those outside the bounds, or too far away for max_voxels, are ignored. Where not all
  /// of them fit into max_voxels, those nearest to what is known, or else to most of the others, come first:
  /// a stray value far away must not take the room of the robot's surroundings.
  /// @return The changed voxels; valid until the next call.
  std::span<const StateChange> Apply(std::span<const VoxelChange> changes);
  /// Marks the unknown space that the robot's body fills as free, because a camera at its front never sees
  /// that space. Returns what Apply returns.
  /// @param radius  [m] Radius of the body, without margin.
  std::span<const StateChange> Vacate(const Eigen::Vector3d& p_W, double radius);
  /// Replaces the no-go boxes. Costs a rebuild of the grid, O(voxels), when they differ.
  void SetNoGo(const std::vector<Eigen::AlignedBox3d>& boxes);
  /// Whether a body centered in voxel `i` would reach into a box.
  bool ReachesInto(const Eigen::AlignedBox3d& box, const VoxelIndex& i) const {
    return BlockedBy(VoxelsWithin(box, voxel_size()), i);
  }
  /// Whether a body of that radius [m] at `p_W` touches the voxels of a box. Its height is that of the map's
  /// bodies.
  bool Touches(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p_W, double radius) const;
  /// The same map for a body that keeps less clearance. O(voxels).
  /// @param clearance  [m] At most that of this map.
  PlanningMap WithClearance(double clearance) const;
  /// Forgets everything known; the plane stays.
  void Reset();
  /// Restricts the robot to driving with its center at this height [m]. Needs a half_height.
  void SetPlane(double z_W);
  const std::optional<double>& plane() const { return plane_; }
  /// What is to be explored, but for no-go boxes: with a plane, no more than the band.
  const VoxelBox& bounds() const { return bounds_; }

  /// Number of values too far away for max_voxels.
  std::size_t beyond_limit() const { return beyond_limit_; }

  const Options& options() const { return options_; }
  double voxel_size() const { return options_.voxel_size; }
  /// Contains everything known. Every free voxel within the bounds and every traversable one lies at least
  /// one voxel inside the box's faces, so its neighbors are in the box.
  const VoxelBox& box() const { return states_.box(); }
  const DenseGrid<VoxelState>& states() const { return states_; }
  VoxelState State(const VoxelIndex& i) const { return states_.Get(i, VoxelState::kUnknown); }
  /// Known, but not with confidence; see DoubtOptions.
  bool Doubtful(const VoxelIndex& i) const { return doubtful_.Get(i, 0) != 0; }
  /// Nonzero for doubtful voxels. Covers the box, or is empty when doubt is disabled.
  const DenseGrid<std::uint8_t>& doubtful() const { return doubtful_; }
  VoxelIndex IndexOf(const Eigen::Vector3d& p_W) const { return VoxelAt(p_W, voxel_size()); }
  Eigen::Vector3d CenterOf(const VoxelIndex& i) const { return VoxelCenter(i, voxel_size()); }
  /// Position [m] of the camera of a level body. Its horizontal offset from the body's center is ignored,
  /// because the robot's heading is decided last.
  Eigen::Vector3d EyeAt(const Eigen::Vector3d& p_W) const {
    return {p_W.x(), p_W.y(), plane_.value_or(p_W.z()) + options_.camera_height};
  }
  /// Converts the voxel of a body to that of its camera, and back.
  VoxelIndex EyeOf(const VoxelIndex& body) const { return {body.x, body.y, body.z + eye_layers_}; }
  VoxelIndex BodyOf(const VoxelIndex& eye) const { return {eye.x, eye.y, eye.z - eye_layers_}; }
  /// Whether this voxel is to be explored at all.
  bool InBounds(const VoxelIndex& i) const { return bounds_.Contains(i) && !NoGo(i); }
  /// Whether part of the voxel lies in a no-go box, which obstructs the body but not the camera.
  bool NoGo(const VoxelIndex& i) const { return !no_go_.empty() && NoGoAmong(i); }

  bool Traversable(const VoxelIndex& i) const {
    return states_.Contains(i) && Traversable(states_.Offset(i));
  }
  bool Traversable(std::size_t offset) const { return blockers_[offset] == 0; }
  /// For each voxel of the box, in grid order, how many voxels block a body there.
  std::span<const std::uint16_t> blockers() const { return {blockers_.data(), blockers_.size()}; }
  std::size_t traversable_count() const { return traversable_count_; }

  enum class Obstacles : std::uint8_t {
    kOccupied,
    kOccupiedAndUnknown,
    kAllButSurelyFree,  ///< Weakly free voxels as well, see OccupancyGrid.
  };
  /// [m] Distance from a point to the nearest obstacle voxel's cube, or `limit` when none is nearer: the
  /// largest radius that a body may have there. For a cylinder with gaps h from its axis and v from its
  /// center's height it is max(h, v - half_height + clearance); on a plane it is h for everything in the
  /// band. O((limit / voxel_size)^3).
  double ClearanceAt(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit) const;
  /// Whether a body of radius `clearance` can move from a to b without touching an obstacle voxel.
  bool SegmentClear(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                    double clearance) const;
  /// Obstacle voxels that a body touches, with the radius that it may have beside each.
  struct Touched {
    VoxelIndex voxel;
    double gap;  ///< [m] As in ClearanceAt.
  };
  /// Those that a body of that radius [m] touches at `p_W`.
  std::vector<Touched> TouchedAt(const Eigen::Vector3d& p_W, Obstacles obstacles, double radius) const;
  /// As SegmentClear, but for the voxels in `but`, which the body touches already, and exact.
  bool SegmentClearBut(std::span<const Touched> but, const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W,
                       Obstacles obstacles, double radius) const;
  /// Whether a body of that radius [m] that moves from a to b touches no obstacle voxel but those that it
  /// touches at a, and comes no nearer to these than it is to the nearest of them. The distance to a voxel
  /// along a segment is convex, so what it does not touch any more it never touches again.
  bool ClearToLeave(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                    double radius) const;
  /// Least clearance between a and b, or `limit` when it is nowhere less; accurate to a sixteenth of a voxel.
  double SegmentClearance(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                          double limit) const;
  /// Whether all voxels between the two points, apart from both ends, are free: a clear line of sight.
  bool InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

 private:
  template <class Visitor>
  void ForEachObstacle(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit, Visitor&& visit) const;
  bool IsObstacle(const VoxelIndex& i, Obstacles obstacles) const;
  double GapTo(const VoxelIndex& i, const Eigen::Vector3d& p_W) const;
  double LeastGapTo(const VoxelIndex& i, const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;
  bool NoGoAmong(const VoxelIndex& i) const;
  bool BlockedBy(const VoxelBox& no_go, const VoxelIndex& i) const;
  bool InBand(const VoxelIndex& i) const { return i.z >= bounds_.min.z && i.z < bounds_.max.z; }
  VoxelBox LookedThrough() const;
  bool IsLookedThrough(const VoxelIndex& i) const;
  void FindBlocking();
  bool HasRoomFor(std::span<const VoxelChange> changes) const;
  std::vector<VoxelChange> NearestFirst(std::span<const VoxelChange> changes) const;
  void Apply(const VoxelChange& change);
  void SetState(const VoxelIndex& i, VoxelState now);
  bool Grow(const VoxelIndex& include);
  void Rebuild(const VoxelBox& box);
  void CountBlockers();
  void Block(const VoxelIndex& i, int by);

  Options options_;
  std::optional<double> plane_;  ///< [m]
  int layer_ = 0;                ///< z index of the plane's voxels.
  int eye_layers_ = 0;           ///< Layers from a body's voxel up to its camera's voxel.
  VoxelBox bounds_;              ///< What is to be explored,
  std::vector<VoxelBox> no_go_;  ///< except for these.
  int reach_ = 0;                ///< The body's, in voxels.
  /// Offsets of the voxels that voxel 0 blocks, including itself. On a plane these are offsets within the
  /// plane's layer, whatever the layer of the blocking voxel.
  std::vector<VoxelIndex> blocking_;
  DenseGrid<VoxelState> states_;
  DenseGrid<std::uint8_t> doubtful_;
  DenseGrid<std::uint8_t> weakly_free_;  ///< Nonzero for weakly free voxels.
  DenseGrid<std::uint16_t>
      blockers_;  ///< Occupied and unknown voxels within clearance, itself included; out of bounds adds one.
  std::size_t traversable_count_ = 0;
  std::size_t beyond_limit_ = 0;
  std::vector<StateChange> changes_;
};

}  // namespace thalweg::explorer
