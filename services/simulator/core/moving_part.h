#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"

namespace thalweg::simulator {

/// A solid box that moves by a timetable, as a door or a chair does.
struct MovingPart {
  /// Where the box is at a time: turned about the pivot, then shifted.
  struct Place {
    double time = 0.0;                                   ///< [s] on the part's own clock, which begins at 0.
    double yaw = 0.0;                                    ///< [rad] counterclockwise, seen from above.
    Eigen::Vector3d offset_W = Eigen::Vector3d::Zero();  ///< [m]
  };
  Eigen::AlignedBox3d at_rest_W;                      ///< [m] The box with no turn and no offset.
  Eigen::Vector3d pivot_W = Eigen::Vector3d::Zero();  ///< [m] A point of the vertical axis of turns.
  std::vector<Place> places;                          ///< Rising times; empty: it always rests.
  double period = 0.0;  ///< [s] After which the timetable begins again, not before the last time; 0 = never.
};

/// Where a part is at a time of its own clock: maps points of the resting box to W. Between two places it
/// moves linearly, in yaw and in offset. Before the first and after the last place it stands; with a period,
/// it moves meanwhile from the last to the first.
RigidTransform PoseAt(const MovingPart& part, double time);

/// [m/s] No point of the part is ever faster.
double FastestOf(const MovingPart& part);

/// Calls `visit` with poses all over the timetable, so dense that no point of the part moves by more than
/// `step` [m] from one to the next.
void VisitPoses(const MovingPart& part, double step, const std::function<void(const RigidTransform&)>& visit);

/// [m] Distance from the body of a robot at `p_W` to a part at a pose; negative when the two overlap.
double DistanceTo(const MovingPart& part, const RigidTransform& T_WP, const RobotModel& robot,
                  const Eigen::Vector3d& p_W);

/// A part on its way, with a clock of its own. It does not run into the robot: where its next place would be
/// nearer than kKeepOff to the body, and nearer than it is, the clock stops until the robot has left. What
/// touches the robot is therefore always what the robot flew into.
/// Threading: const calls from any number of threads.
class PartInMotion {
 public:
  static constexpr double kKeepOff = 0.05;  ///< [m]

  explicit PartInMotion(MovingPart part) : part_(std::move(part)), T_WP_(PoseAt(part_, 0.0)) {}

  const MovingPart& part() const { return part_; }
  double clock() const { return clock_; }               ///< [s]
  bool waits() const { return waits_; }                 ///< Whether the last Advance stopped the clock.
  const RigidTransform& T_WP() const { return T_WP_; }  ///< The present pose, see PoseAt.

  /// Lets `dt` seconds pass, with the robot at `p_W`.
  /// @return [m] No point of the part has moved by more.
  double Advance(double dt, const RobotModel& robot, const Eigen::Vector3d& p_W);

  /// Where a ray meets the box, from without or from within.
  struct Meeting {
    double distance = 0.0;      ///< [m] along the ray.
    Eigen::Vector3d normal_W;   ///< Unit length, facing the ray's origin.
    Eigen::Vector3d at_rest_W;  ///< Where this point of the box is when the box is at rest.
  };
  /// @param direction_W  Unit length.
  std::optional<Meeting> CastRay(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W,
                                 double max_distance) const;
  /// [m] Distance from a point to the box; 0 inside.
  double DistanceTo(const Eigen::Vector3d& p_W) const;
  /// [m] Distance from a robot's body to the box; negative when the two overlap.
  double DistanceTo(const RobotModel& robot, const Eigen::Vector3d& p_W) const {
    return simulator::DistanceTo(part_, T_WP_, robot, p_W);
  }

 private:
  MovingPart part_;
  RigidTransform T_WP_;
  double clock_ = 0.0;
  bool waits_ = false;
};

}  // namespace thalweg::simulator
