#include "services/explorer/core/errand.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/geometry/point_text.h"
#include "common/voxel/grid_order.h"
#include "services/explorer/core/map/frontier.h"

namespace thalweg::explorer {
namespace {

/// [m] How far the frontier may be that is looked at in place of a point that nothing sees.
constexpr double kBeside = 0.5;
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

/// The heading in which a path ends.
double HeadingOf(const std::vector<Eigen::Vector3d>& path_W, const Eigen::Matrix3d& R_WB) {
  const Eigen::Vector3d step = path_W.back() - path_W[path_W.size() - 2];
  const bool steep = step.head<2>().norm() < kFlat;
  return steep ? YawOf(R_WB) : std::atan2(step.y(), step.x());
}

/// The orientation in which a camera sees a voxel: the camera's own axis on it where the body may turn so,
/// else the nearest view that shows it.
Eigen::Matrix3d Aimed(const Sighting& sighting, const Knowledge& knowledge, const Eigen::Matrix3d& R_WB) {
  const Eigen::Vector3d& to = sighting.offset_W;
  const double flat = to.head<2>().norm();
  const double yaw = flat < kFlat ? YawOf(R_WB) : std::atan2(to.y(), to.x());
  const double pitch = knowledge.views().robot().PitchWithin(std::atan2(to.z(), flat));
  Eigen::Matrix3d straight = RotationFromYawPitch(yaw, pitch);
  if (knowledge.views().Shows(straight, sighting)) return straight;
  return knowledge.views().Best({sighting}, {true}, {}, R_WB).R_WB;
}

/// The frontier voxels within kBeside of a voxel to which unknown space leads from it, so that they lie on
/// the same side of a wall. The middle of a frontier, which people click on, is often hidden behind them.
std::vector<VoxelIndex> FrontierBeside(const PlanningMap& map, const VoxelIndex& voxel) {
  const double reach = kBeside / map.voxel_size();
  std::vector<VoxelIndex> beside;
  std::set<VoxelIndex, GridOrder> met = {voxel};
  for (std::vector<VoxelIndex> queue = {voxel}; !queue.empty();) {
    const VoxelIndex at = queue.back();
    queue.pop_back();
    if (IsTarget(map, at)) beside.push_back(at);
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex to = at + step;
      const VoxelIndex d = to - voxel;
      if (d.x * d.x + d.y * d.y + d.z * d.z > reach * reach || map.State(to) != VoxelState::kUnknown)
        continue;
      if (met.insert(to).second) queue.push_back(to);
    }
  }
  return beside;
}

/// What is needed to search for the path of an errand.
struct Search {
  const Knowledge& knowledge;
  const RigidTransform& T_WB;
  const GoalFinder& goal_finder;
  const ErrandOptions& options;

  const PlanningMap& map() const { return knowledge.map(); }
  Eigen::Vector3d from_W() const { return T_WB.translation(); }
  /// Floods first with the narrow exemption, then with the wide one, until `find(search)` has found a path.
  template <class Find>
  std::optional<ErrandPath> First(Find&& find) const {
    PathSearch search;
    for (const PathSearch::Exemption& exemption :
         {PathSearch::Exemption{options.exemption}, PathSearch::Exemption{options.wide_exemption, true}}) {
      search.Flood(map(), PathSearch::StartAt(map(), from_W(), options.robot_radius, exemption));
      if (std::optional<ErrandPath> found = find(search)) return found;
    }
    return std::nullopt;
  }
};

std::optional<ErrandPath> PathInto(const VoxelIndex& goal, const std::optional<double>& yaw_W,
                                   const Search& in) {
  return in.First([&](const PathSearch& search) -> std::optional<ErrandPath> {
    if (!search.Reached(goal)) return std::nullopt;
    ErrandPath found{search.PathFrom(in.map(), in.from_W(), goal), {}};
    found.R_WB = RotationFromYawPitch(yaw_W ? *yaw_W : HeadingOf(found.path_W, in.T_WB.linear()), 0.0);
    return found;
  });
}

/// The path to where some of the voxels are in sight.
std::optional<ErrandPath> PathToSee(const std::vector<VoxelIndex>& shown, const VoxelIndex& point,
                                    const Search& in) {
  const PlanningMap& map = in.map();
  const ViewPlanner& views = in.knowledge.views();
  // With the camera on the point, unless nothing in sight is in its image then.
  const auto looking_from = [&](std::vector<Eigen::Vector3d> path_W) -> std::optional<ErrandPath> {
    const Eigen::Vector3d eye_W = map.EyeAt(path_W.back());
    std::vector<Sighting> sightings;
    for (const VoxelIndex& i : shown) {
      if (views.CanSee(map, eye_W, map.CenterOf(i), in.options.sensor_range))
        sightings.push_back({i, map.CenterOf(i) - eye_W});
    }
    if (sightings.empty()) return std::nullopt;
    Eigen::Matrix3d R_WB = Aimed({point, map.CenterOf(point) - eye_W}, in.knowledge, in.T_WB.linear());
    if (std::ranges::none_of(sightings, [&](const Sighting& seen) { return views.Shows(R_WB, seen); }))
      R_WB = views.Best(sightings, std::vector<bool>(sightings.size(), true), {}, in.T_WB.linear()).R_WB;
    return ErrandPath{std::move(path_W), R_WB};
  };
  if (std::optional<ErrandPath> here = looking_from({in.from_W()})) return here;
  const Cluster cluster{.unknowns = shown, .center_W = map.CenterOf(point)};
  return in.First([&](const PathSearch& search) -> std::optional<ErrandPath> {
    const std::vector<VoxelIndex> goals = in.goal_finder.GoalsOf(cluster, map, search, views);
    if (goals.empty()) return std::nullopt;
    return looking_from(search.PathFrom(map, in.from_W(), goals.front()));
  });
}

}  // namespace

Result<ErrandPath> FindErrandPath(const Errand& errand, const RigidTransform& T_WB,
                                  const Knowledge& knowledge, const GoalFinder& goal_finder,
                                  const ErrandOptions& options) {
  const Search in{knowledge, T_WB, goal_finder, options};
  const PlanningMap& map = knowledge.map();
  Eigen::Vector3d point_W = errand.p_W;
  if (errand.kind == Errand::Kind::kGoTo) {
    if (map.plane()) point_W.z() = *map.plane();
    const VoxelIndex goal = map.IndexOf(point_W);
    if (const std::string why = Obstruction(map, goal); !why.empty())
      return Error{"the goal " + PointText(point_W) + " " + why};
    if (std::optional<ErrandPath> found = PathInto(goal, errand.yaw_W, in)) return *std::move(found);
    return Error{"no known path leads to " + PointText(point_W)};
  }
  const VoxelIndex point = map.IndexOf(point_W);
  if (std::optional<ErrandPath> found = PathToSee({point}, point, in)) return *std::move(found);
  if (const std::vector<VoxelIndex> beside = FrontierBeside(map, point); !beside.empty()) {
    if (std::optional<ErrandPath> found = PathToSee(beside, point, in)) return *std::move(found);
  }
  return Error{"no place that the robot can reach is known to see " + PointText(point_W)};
}

}  // namespace thalweg::explorer
