#include "services/explorer/core/no_go_paths.h"

#include <string>

namespace thalweg::explorer {
namespace {

std::vector<Eigen::Vector3d> PathOutTowardsHome(const Eigen::Vector3d& p_W, NoGoBoxes& no_go,
                                                Mission& mission, Knowledge& knowledge) {
  const PlanningMap& map = knowledge.map();
  no_go.PutUpAll(knowledge);
  mission.KnowsPathHome(map, p_W);
  const DenseGrid<std::uint32_t> costs = mission.home_paths().costs();  // with the boxes
  no_go.PutUp(p_W, knowledge);
  mission.FindPathsHome(map, p_W);
  return no_go.PathOut(map, p_W, [&](const VoxelIndex& i) {
    return costs.Get(i, PathSearch::kUnreached) != PathSearch::kUnreached;
  });
}

}  // namespace

std::vector<Eigen::Vector3d> PathOutOfNoGo(const Eigen::Vector3d& p_W, NoGoBoxes& no_go, Mission& mission,
                                           Knowledge& knowledge) {
  if (mission.must_return()) {
    std::vector<Eigen::Vector3d> path_W = PathOutTowardsHome(p_W, no_go, mission, knowledge);
    if (!path_W.empty()) return path_W;
  }
  return no_go.PathOut(knowledge.map(), p_W, [](const VoxelIndex&) { return true; });
}

std::optional<Error> DrawNoGo(const Eigen::AlignedBox3d& box_W, const Eigen::Vector3d& p_W,
                              double robot_radius, NoGoBoxes& no_go, Mission& mission, Knowledge& knowledge) {
  if (no_go.drawn().size() == NoGoBoxes::kMostDrawn)
    return Error{"there are " + std::to_string(NoGoBoxes::kMostDrawn) + " boxes already; clear them first"};
  const PlanningMap& map = knowledge.map();
  const bool must_return = mission.must_return();
  const std::optional<Eigen::Vector3d>& home_W = mission.home_paths().home_W();
  if (must_return && map.Touches(box_W, home_W.value_or(p_W), robot_radius))
    return Error{"it would cover the place to which the robot must return"};
  const bool had_path_home = must_return && mission.KnowsPathHome(map, p_W);
  no_go.Draw(box_W);
  no_go.PutUp(p_W, knowledge);
  std::optional<Error> error;
  const bool inside = no_go.robot_inside();
  if (inside && PathOutOfNoGo(p_W, no_go, mission, knowledge).empty()) {
    error = Error{"the robot stands in it, and no known path leads out of it"};
  } else if (had_path_home && (inside ? PathOutTowardsHome(p_W, no_go, mission, knowledge).empty()
                                      : !mission.KnowsPathHome(map, p_W))) {
    error = Error{"it would cut the robot off from the place to which it must return"};
  }
  if (error) {
    no_go.Undraw();
    no_go.PutUp(p_W, knowledge);
    if (had_path_home) mission.FindPathsHome(map, p_W);
  }
  return error;
}

}  // namespace thalweg::explorer
