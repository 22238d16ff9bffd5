#include "services/explorer/core/errand.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/point_text.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::explorer {
namespace {

constexpr double kBeside =
    0.5;                        // [m] What is that near to a point that is not in sight is looked at instead.
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

/// The unknown voxels on the frontier that lie within kBeside of a voxel. The middle of a frontier, which
/// people click on, is often hidden behind them.
std::vector<VoxelIndex> FrontierBeside(const PlanningMap& map, const VoxelIndex& voxel) {
  const int reach = static_cast<int>(kBeside / map.voxel_size());
  const VoxelBox around{voxel - VoxelIndex{reach, reach, reach},
                        voxel + VoxelIndex{reach + 1, reach + 1, reach + 1}};
  std::vector<VoxelIndex> beside;
  ForEachVoxel(Intersection(around, map.box()), [&](const VoxelIndex& i) {
    const VoxelIndex d = i - voxel;
    if (d.x * d.x + d.y * d.y + d.z * d.z <= reach * reach && IsTarget(map, i)) beside.push_back(i);
  });
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
    found.R_WB = yaw_W ? RotationFromYawPitch(*yaw_W, 0.0) : HeadingOf(found.path_W, in.T_WB.linear());
    return found;
  });
}

/// The path to where one of some voxels is in sight, with the camera on the point.
std::optional<ErrandPath> PathToSee(const std::vector<VoxelIndex>& shown, const VoxelIndex& point,
                                    const Search& in) {
  const PlanningMap& map = in.map();
  const auto looking_from = [&](std::vector<Eigen::Vector3d> path_W) {
    const Sighting sighting{point, map.CenterOf(point) - map.EyeAt(path_W.back())};
    return ErrandPath{std::move(path_W), Aimed(sighting, in.knowledge, in.T_WB.linear())};
  };
  const ViewPlanner& views = in.knowledge.views();
  if (std::ranges::any_of(shown, [&](const VoxelIndex& i) {
        return views.CanSee(map, map.EyeAt(in.from_W()), map.CenterOf(i), in.options.sensor_range);
      }))
    return looking_from({in.from_W()});
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
