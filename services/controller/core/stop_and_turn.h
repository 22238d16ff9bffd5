#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/controller/core/path_follower.h"

namespace thalweg::controller {

/// Leads the robot from pose to pose of its path: at each one it stops, turns on the spot to the orientation
/// of the next, then moves straight there. For bases that cannot do both at once, and for odometry from
/// images that suffers from turns in motion. A robot that must face where it moves faces along each leg.
///
/// A PathFollower gets one turn or leg at a time, as a path of its own, and its limits, checks and stops are
/// those of this controller, too; only the leg that it follows is checked against the map. While a new path
/// is to be joined it gets an empty one, so that the robot brakes hard before it turns away.
class StopAndTurn final : public MotionController {
 public:
  /// Throws std::invalid_argument naming the invalid option.
  explicit StopAndTurn(const PathFollower::Options& options);

  void SetPath(Time id, std::vector<RigidTransform> T_WBs, Time now) override;
  void SetPose(const RigidTransform& T_WB, Time stamp) override;
  void SetLost(bool lost, Time stamp) override { follower_.SetLost(lost, stamp); }
  void SetMap(const OccupancyGrid& map, Time now) override { follower_.SetMap(map, now); }
  void SetStays(bool stays) override { follower_.SetStays(stays); }
  Motion Step(Time now) override;
  /// To the end of the present turn or leg.
  std::vector<TrajectoryPoint> Preview(double step, double horizon) const override {
    return follower_.Preview(step, horizon);
  }

 private:
  struct Leg {
    std::vector<RigidTransform> T_WBs;
    double length = 0.0;  ///< [m]
  };
  struct Path {
    Time id;
    std::vector<RigidTransform> T_WBs;
    double length = 0.0;  ///< [m]
    Time heard;
  };

  bool AdvanceFrom(const Motion& motion);
  bool MakeLegs(const Motion& motion);
  RigidTransform EndOf(const RigidTransform& from, const RigidTransform& to, bool is_last) const;
  void HoldStill();
  void HandOver(std::vector<RigidTransform> T_WBs);
  Motion Whole(Motion of_leg) const;

  PathFollower follower_;
  std::optional<Path> path_;
  std::optional<RigidTransform> T_WB_;
  /// Empty until the path has been joined; the follower then has an empty path.
  std::vector<Leg> legs_;
  std::size_t leg_ = 0;  ///< The one that is followed.
  std::vector<RigidTransform> handed_over_;
  std::int64_t hand_overs_ = 0;  ///< Counts them, since the follower tells paths apart by their ids.
  StopReason last_reason_ = StopReason::kNone;
};

}  // namespace thalweg::controller
