#pragma once

#include <optional>
#include <span>

#include "common/base/time.h"
#include "common/geometry/robot_model.h"
#include "common/geometry/scan_view.h"
#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/map/planning_map.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// What the robot knows: the map it plans on, and which unknown voxels it has looked at, how often, and with
/// what result. Takes in what the mapper reports, and counts each scan as a look at every unknown voxel in
/// its view. Threading: one thread owns it.
class Knowledge {
 public:
  struct Options {
    PlanningMap::Options map;
    LookMemory::Options memory;
    RobotModel robot;
    PinholeCamera camera;
    double look_range = 3.0;  ///< [m] An unknown voxel in view nearer than this was looked at.
    /// A look sensed nothing where less than this share of its part of the image (MeasuredShares) has a
    /// depth.
    double min_measured_share = 0.5;
    double reach = 0.3;  ///< [m] Free space within this distance of the robot makes its place known.
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit Knowledge(const Options& options);

  /// Forgets the map and everything remembered about it.
  void Reset();
  /// Takes in changes and the scans that made them.
  void Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now);
  /// The robot is there: the space its body fills is free.
  void Occupy(const Eigen::Vector3d& p_W);
  /// The pose with a driving robot's height fixed to the one at the first call, whatever its odometry says.
  RigidTransform InPlane(const RigidTransform& T_WB);

  /// Whether the map knows free space at the robot.
  bool KnowsPlace(const RigidTransform& T_WB) const;
  /// What the last scan had in the direction of a voxel; nothing when that is outside its image, or unknown.
  std::optional<Sensed> LastSensed(const VoxelIndex& i) const;
  /// The unknown voxels in sight from the camera of a body there, whatever its direction.
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
  std::optional<RigidTransform> counted_T_WC_;  ///< Of the last scan whose looks were counted.
  std::optional<ScanView> last_scan_;
};

}  // namespace thalweg::explorer
