#pragma once

#include <optional>
#include <span>

#include "common/base/time.h"
#include "common/geometry/robot_model.h"
#include "common/geometry/scan_view.h"
#include "services/explorer/core/map/inspected_surface.h"
#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/map/planning_map.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// What the robot knows: the map for planning, and which unknown voxels it has looked at, how often, and with
/// what result. Applies the mapper's updates and counts each scan as a look at every unknown voxel in its
/// view.
/// Threading: one thread owns it.
class Knowledge {
 public:
  struct Options {
    PlanningMap::Options map;
    LookMemory::Options memory;
    RobotModel robot;
    PinholeCamera camera;
    double look_range;  ///< [m] A look covers the unknown voxels in view within this distance.
    /// A look at a voxel sensed nothing when less than this share of the surrounding part of the image has a
    /// depth (MeasuredShares).
    double min_measured_share;
    /// [m] The robot's surroundings are known once there is free space within this distance.
    double reach;
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit Knowledge(const Options& options);

  /// Forgets the map and everything remembered about it.
  void Reset();
  /// Applies map changes and the scans that caused them.
  void Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now);
  /// Marks the space that the robot's body fills as free.
  void Occupy(const Eigen::Vector3d& p_W);
  /// Replaces the boxes that the robot stays out of.
  void SetNoGo(const std::vector<Eigen::AlignedBox3d>& boxes) { map_.SetNoGo(boxes); }
  /// Begins to remember which surface is inspected, or ends it.
  void Inspect(const std::optional<InspectionCriterion>& criterion);
  /// What was inspected since; null = nothing is remembered.
  InspectedSurface* inspected() { return inspected_ ? &*inspected_ : nullptr; }
  const InspectedSurface* inspected() const { return inspected_ ? &*inspected_ : nullptr; }
  /// For a driving robot, replaces the height by that of the first call, whatever its odometry reports.
  RigidTransform InPlane(const RigidTransform& T_WB);

  /// Whether the map knows free space at the robot.
  bool KnowsPlace(const RigidTransform& T_WB) const;
  /// What the last scan sensed in the direction of a voxel; empty when that is outside its image, or without
  /// a scan.
  std::optional<Sensed> LastSensed(const VoxelIndex& i) const;
  /// The unknown voxels in sight of the camera of a body at `p_W`, whatever its heading.
  std::vector<Sighting> SightingsFromBody(const Eigen::Vector3d& p_W) const;

  const PlanningMap& map() const { return map_; }
  const LookMemory& memory() const { return memory_; }
  LookMemory& memory() { return memory_; }
  const ViewPlanner& views() const { return views_; }
  double look_range() const { return options_.look_range; }

 private:
  void Follow(std::span<const PlanningMap::StateChange> changes);
  std::optional<Sensed> SensedBy(const ScanView& scan, const VoxelIndex& i) const;

  Options options_;
  PlanningMap map_;
  LookMemory memory_;
  ViewPlanner views_;
  std::optional<InspectedSurface> inspected_;
  std::optional<RigidTransform> counted_T_WC_;  ///< Pose of the last scan that was counted as a look.
  std::optional<ScanView> last_scan_;
};

}  // namespace thalweg::explorer
