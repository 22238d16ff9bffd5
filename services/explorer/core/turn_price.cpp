#include "services/explorer/core/turn_price.h"

#include <algorithm>
#include <cmath>

#include "common/base/angles.h"
#include "services/explorer/core/path/motion_times.h"
#include "services/explorer/core/path/narrow_passage.h"

namespace thalweg::explorer {

double AngleWellInView(const PinholeCamera& camera, const RobotModel& robot) {
  constexpr double kWellInside = 2.0 / 3.0;
  const double to_side = std::atan(0.5 * camera.width_px / camera.fx);
  const double to_top = std::atan(0.5 * camera.height_px / camera.fy);
  return kWellInside * (robot.level() ? to_side : std::min(to_side, to_top));
}

double PriceOfTurn(const VoxelIndex& place, double length, const Eigen::Vector3d& point_W,
                   const RigidTransform& T_WB, const PlanningMap& map, const PinholeCamera& camera,
                   const RobotModel& robot) {
  const double shown = AngleWellInView(camera, robot);
  const auto along = [&](const Eigen::Vector3d& direction_W) {
    return robot.level() ? Eigen::Vector3d(direction_W.x(), direction_W.y(), 0.0) : direction_W;
  };
  const auto turn_time = [&](const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W, double free) {
    if (to_W.norm() < map.voxel_size()) return 0.0;
    const double angle = std::atan2(from_W.cross(to_W).norm(), from_W.dot(to_W)) - free;
    return TurnTime(std::max(0.0, angle), robot);
  };
  const Eigen::Vector3d goal_W = map.CenterOf(place);
  const Eigen::Vector3d ahead_W = along(T_WB.linear().col(0));
  const Eigen::Vector3d travel_W = along(goal_W - T_WB.translation());
  const Eigen::Vector3d sight_W = along(point_W - goal_W);
  const bool faces_travel = travel_W.norm() >= map.voxel_size() && IsNarrow(map, goal_W, robot);
  const double time = faces_travel ? turn_time(ahead_W, travel_W, 0.0) + turn_time(travel_W, sight_W, shown)
                                   : turn_time(ahead_W, sight_W, shown);
  return std::max(0.0, UsualPath(time, robot) - length);
}

}  // namespace thalweg::explorer
