#include "services/explorer/core/errand.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/point_text.h"

namespace thalweg::explorer {
namespace {

constexpr double kFlat = 1e-3;  // [m] A step that is horizontally shorter than this has no heading.

/// Why a body cannot stand in a voxel; empty if it can.
std::string Obstruction(const PlanningMap& map, const VoxelIndex& i) {
  if (map.Traversable(i)) return {};
  if (map.NoGo(i)) return "lies in a no-go box";
  if (!map.InBounds(i)) return "lies outside the bounds of the exploration";
  if (map.State(i) == VoxelState::kUnknown) return "lies in space that is not known yet";
  if (map.State(i) == VoxelState::kOccupied) return "lies in an obstacle";
  return "is free, but too near to an obstacle, a no-go box or unknown space for the robot's body";
}

/// The level orientation in which a path ends.
Eigen::Matrix3d HeadingOf(const std::vector<Eigen::Vector3d>& path_W, const Eigen::Matrix3d& R_WB) {
  const Eigen::Vector3d step = path_W.back() - path_W[path_W.size() - 2];
  const bool steep = step.head<2>().norm() < kFlat;
  return RotationFromYawPitch(steep ? YawOf(R_WB) : std::atan2(step.y(), step.x()), 0.0);
}

/// The orientation in which a camera sees a voxel: the camera's own axis on it where the body may turn so,
/// else the nearest view that shows it.
Eigen::Matrix3d Aimed(const Sighting& sighting, const Knowledge& knowledge, const Eigen::Matrix3d& R_WB) {
  const Eigen::Vector3d& to = sighting.offset_W;
  const double flat = to.head<2>().norm();
  const double yaw = flat < kFlat ? YawOf(R_WB) : std::atan2(to.y(), to.x());
  const double pitch = knowledge.views().level() ? 0.0 : std::atan2(to.z(), flat);
  const Eigen::Matrix3d straight = RotationFromYawPitch(yaw, pitch);
  if (knowledge.views().Shows(straight, sighting)) return straight;
  return knowledge.views().Best({sighting}, {true}, {}, R_WB).R_WB;
}

Sighting SightingAt(const PlanningMap& map, const Eigen::Vector3d& p_W, const VoxelIndex& voxel) {
  return {voxel, map.CenterOf(voxel) - map.EyeAt(p_W)};
}

}  // namespace

Result<ErrandPath> FindErrandPath(const Errand& errand, const RigidTransform& T_WB,
                                  const Knowledge& knowledge, const GoalFinder& goal_finder,
                                  const ErrandOptions& options) {
  const PlanningMap& map = knowledge.map();
  const Eigen::Vector3d p_W = T_WB.translation();
  const bool goes = errand.kind == Errand::Kind::kGoTo;
  Eigen::Vector3d point_W = errand.p_W;
  if (goes && map.plane()) point_W.z() = *map.plane();
  const VoxelIndex voxel = map.IndexOf(point_W);
  if (goes) {
    if (const std::string why = Obstruction(map, voxel); !why.empty())
      return Error{"the goal " + PointText(point_W) + " " + why};
  } else if (knowledge.views().CanSee(map, map.EyeAt(p_W), map.CenterOf(voxel), options.sensor_range)) {
    return ErrandPath{{p_W}, Aimed(SightingAt(map, p_W, voxel), knowledge, T_WB.linear())};
  }
  PathSearch search;
  for (const PathSearch::Exemption& exemption :
       {PathSearch::Exemption{options.exemption}, PathSearch::Exemption{options.wide_exemption, true}}) {
    search.Flood(map, PathSearch::StartAt(map, p_W, options.robot_radius, exemption));
    if (goes) {
      if (!search.Reached(voxel)) continue;
      ErrandPath found{search.PathFrom(map, p_W, voxel), T_WB.linear()};
      found.R_WB =
          errand.yaw_W ? RotationFromYawPitch(*errand.yaw_W, 0.0) : HeadingOf(found.path_W, T_WB.linear());
      return found;
    }
    const Cluster cluster{.unknowns = {voxel}, .center_W = map.CenterOf(voxel)};
    const std::vector<VoxelIndex> goals = goal_finder.GoalsOf(cluster, map, search, knowledge.views());
    if (goals.empty()) continue;
    ErrandPath found{search.PathFrom(map, p_W, goals.front()), T_WB.linear()};
    found.R_WB = Aimed(SightingAt(map, found.path_W.back(), voxel), knowledge, T_WB.linear());
    return found;
  }
  if (goes) return Error{"no known path leads to " + PointText(point_W)};
  return Error{"no place that the robot can reach is known to see " + PointText(point_W)};
}

}  // namespace thalweg::explorer
