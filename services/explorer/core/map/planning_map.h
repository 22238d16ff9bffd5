#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/map_model.h"
#include "common/voxel/dense_grid.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::explorer {

/// Known voxels that are nearly as likely free as occupied can be looked at again, as targets that are worth
/// less than unknown ones.
struct DoubtOptions {
  double max_log_odds = 0.0;  ///< A known voxel of |log odds| below that is doubtful; 0 = none is.
  double weight = 0.5;        ///< Of a doubtful voxel, an unknown one being 1; in (0, 1].
};

/// The known world as the planner needs it: a dense grid of voxel states, and where the robot's body fits,
/// kept up to date voxel by voxel.
///
/// A voxel is traversable when it is free, within the bounds, and the body about its centre touches no voxel
/// that is occupied or unknown, so the robot never enters what it has not seen. The body is a sphere of
/// radius `clearance`, or an upright cylinder: it collides with what is nearer to its axis than `clearance`
/// and less than half_height above or below its center. With a plane the robot drives: the map is the band of
/// heights that its cylinder sweeps, nothing else is explored, and only the voxels of the plane's layer are
/// traversable. Paths over them are planar, and an obstacle anywhere in the band blocks them; the camera
/// looks through what lies between the band and a camera above or below it.
/// Threading: one thread owns a map.
class PlanningMap {
 public:
  struct Options {
    double voxel_size = MapModel{}.voxel_size;  ///< [m]
    double clearance = 0.15;                    ///< [m] Robot's radius and margin.
    double half_height = 0.0;                   ///< [m] Of the upright cylinder; 0 = a sphere.
    std::optional<Eigen::AlignedBox3d> bounds;  ///< [m] Absent: the map grows with what is known,
    std::size_t max_voxels = 50'000'000;        ///< up to a box of so many.
    std::vector<Eigen::AlignedBox3d> no_go =
        {};                      ///< [m] The robot keeps out of them; nothing there is asked for.
    double camera_height = 0.0;  ///< [m] Of the camera over the middle of a level body.
    DoubtOptions doubt = {};
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit PlanningMap(const Options& options);

  /// Applies new values; those beyond the bounds, or too far for max_voxels, are ignored.
  /// @return the voxels whose state or doubtfulness changed, each with what it was before; valid until the
  ///         next call.
  struct StateChange {
    VoxelIndex voxel;
    VoxelState before;
    VoxelState now;
    bool doubtful_before = false;
    bool doubtful_now = false;
  };
  std::span<const StateChange> Apply(std::span<const VoxelChange> changes);
  /// The robot is there: the unknown space that its body fills is free. A camera at its front never sees that
  /// space. Returns what Apply does.
  /// @param radius  [m] Of the body, without a margin.
  std::span<const StateChange> Vacate(const Eigen::Vector3d& p_W, double radius);
  /// Back to knowing nothing; the plane stays.
  void Reset();
  /// From now on the robot drives with its center at that height [m]. Needs a half_height.
  void SetPlane(double z_W);
  const std::optional<double>& plane() const { return plane_; }

  std::size_t beyond_limit() const { return beyond_limit_; }  ///< Values too far for max_voxels.

  const Options& options() const { return options_; }
  double voxel_size() const { return options_.voxel_size; }
  /// All that is known lies inside, every free voxel of the bounds and every traversable one at least one
  /// voxel off the box's faces: their neighbours are inside.
  const VoxelBox& box() const { return states_.box(); }
  const DenseGrid<VoxelState>& states() const { return states_; }
  VoxelState State(const VoxelIndex& i) const { return states_.Get(i, VoxelState::kUnknown); }
  /// Known, but not for sure: see DoubtOptions.
  bool Doubtful(const VoxelIndex& i) const { return doubtful_.Get(i, 0) != 0; }
  /// Not 0 where that is so; without cells where nothing is to be doubted, else over the box.
  const DenseGrid<std::uint8_t>& doubtful() const { return doubtful_; }
  VoxelIndex IndexOf(const Eigen::Vector3d& p_W) const { return VoxelAt(p_W, voxel_size()); }
  Eigen::Vector3d CenterOf(const VoxelIndex& i) const { return VoxelCenter(i, voxel_size()); }
  /// The camera of a level body there [m]. How far it is ahead or aside of the center is ignored, since the
  /// robot's heading is decided last.
  Eigen::Vector3d EyeAt(const Eigen::Vector3d& p_W) const {
    return {p_W.x(), p_W.y(), plane_.value_or(p_W.z()) + options_.camera_height};
  }
  /// The voxel in which the camera of a body in that voxel is, and the other way round.
  VoxelIndex EyeOf(const VoxelIndex& body) const { return {body.x, body.y, body.z + eye_layers_}; }
  VoxelIndex BodyOf(const VoxelIndex& eye) const { return {eye.x, eye.y, eye.z - eye_layers_}; }
  /// Whether this voxel is to be explored at all.
  bool InBounds(const VoxelIndex& i) const { return bounds_.Contains(i) && !NoGo(i); }
  /// Whether a part of it lies in a no-go box: an obstacle to the body, though not to the eye.
  bool NoGo(const VoxelIndex& i) const { return !no_go_.empty() && NoGoAmong(i); }

  bool Traversable(const VoxelIndex& i) const {
    return states_.Contains(i) && Traversable(states_.Offset(i));
  }
  bool Traversable(std::size_t offset) const { return blockers_[offset] == 0; }
  /// For each voxel of the box, in the grid's order, how many voxels block a body there.
  std::span<const std::uint16_t> blockers() const { return {blockers_.data(), blockers_.size()}; }
  std::size_t traversable_count() const { return traversable_count_; }

  enum class Obstacles : std::uint8_t {
    kOccupied,
    kOccupiedAndUnknown,
    kAllButSurelyFree,  ///< What is only weakly free, too: see OccupancyGrid.
  };
  /// [m] from a point to the nearest obstacle voxel's cube, or `limit` when none is nearer: what the radius
  /// of the body may be there. For a cylinder with gaps h to its axis and v to its center's height that is
  /// max(h, v - half_height + clearance); on a plane it is h for all that is in the band. O((limit/size)^3).
  double ClearanceAt(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit) const;
  /// Whether a body of radius `clearance` moves from a to b without touching an obstacle voxel.
  bool SegmentClear(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                    double clearance) const;
  /// The least clearance between a and b, or `limit` when it is nowhere less; to within a sixteenth of a
  /// voxel.
  double SegmentClearance(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                          double limit) const;
  /// Whether all voxels between the two, apart from both ends, are free: b is in plain sight from a.
  bool InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

 private:
  bool NoGoAmong(const VoxelIndex& i) const;
  bool BlockedBy(const VoxelBox& no_go, const VoxelIndex& i) const;
  bool InBand(const VoxelIndex& i) const { return i.z >= bounds_.min.z && i.z < bounds_.max.z; }
  VoxelBox LookedThrough() const;
  bool IsLookedThrough(const VoxelIndex& i) const;
  void FindBlocking();
  void SetState(const VoxelIndex& i, VoxelState now);
  bool Grow(const VoxelIndex& include);
  void Rebuild(const VoxelBox& box);
  void Block(const VoxelIndex& i, int by);

  Options options_;
  std::optional<double> plane_;       ///< [m]
  int layer_ = 0;                     ///< The plane's.
  int eye_layers_ = 0;                ///< From a body's voxel up to its camera's.
  VoxelBox bounds_;                   ///< What is to be explored,
  std::vector<VoxelBox> no_go_;       ///< except for these.
  int reach_ = 0;                     ///< Of the body, in voxels.
  std::vector<VoxelIndex> blocking_;  ///< Offsets of the voxels that a voxel at 0 blocks, itself included; on
                                      ///< a plane it blocks these of the plane's layer, whatever its own.
  DenseGrid<VoxelState> states_;
  DenseGrid<std::uint8_t> doubtful_;
  DenseGrid<std::uint8_t> weakly_free_;  ///< Not 0 where that is so.
  DenseGrid<std::uint16_t>
      blockers_;  ///< Occupied and unknown voxels within clearance, itself included; out of bounds adds one.
  std::size_t traversable_count_ = 0;
  std::size_t beyond_limit_ = 0;
  std::vector<StateChange> changes_;
};

}  // namespace thalweg::explorer
