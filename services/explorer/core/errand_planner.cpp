#include "services/explorer/core/errand_planner.h"

#include <string>
#include <vector>

#include "common/geometry/polyline.h"

namespace thalweg::explorer {

ErrandPlanner::ErrandPlanner(const ExplorerOptions& options)
    : options_{.robot_radius = options.robot.radius,
               .exemption = options.exemption,
               .wide_exemption = options.wide_exemption,
               .sensor_range = options.sensor_range},
      goal_finder_(options.look_range, options.voxel_size) {}

Result<Task> ErrandPlanner::MakeTask(const Errand& errand, const RigidTransform& T_WB, Time now,
                                     const TaskMaker& make, const Mission& mission,
                                     Knowledge& knowledge) const {
  knowledge.Occupy(T_WB.translation());
  const Result<ErrandPath> found = FindErrandPath(errand, T_WB, knowledge, goal_finder_, options_);
  if (!found) return Error{found.error()};
  const Purpose purpose = errand.kind == Errand::Kind::kGoTo ? Purpose::kGoTo : Purpose::kLookAt;
  std::optional<Task> task;
  if (found->path_W.size() == 1) {
    task = make.Turn(purpose, found->R_WB, T_WB);
  } else {
    const std::vector<Eigen::Vector3d> path_W = make.Smoothed(found->path_W);
    if (const auto budget = mission.TooFar(knowledge.map(), PathLength(path_W), path_W.back(), now)) {
      const std::string spent = *budget == Budget::kTime ? "time" : "distance";
      return Error{"the rest of the " + spent + " budget does not allow it"};
    }
    task =
        make.Follow(purpose, path_W, found->R_WB, T_WB, errand.yaw_W ? Heading::kGiven : Heading::kByPurpose);
  }
  if (!task) return Error{"there is no room to turn: the robot turns only in curves"};
  task->plan.target_W = errand.p_W;
  return *std::move(task);
}

}  // namespace thalweg::explorer
