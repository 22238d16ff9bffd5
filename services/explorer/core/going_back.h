#pragma once

#include <optional>
#include <vector>

#include "common/geometry/flown_path.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/loop_rules.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/task_maker.h"

namespace thalweg::explorer {

/// Leads a robot to which the map shows no way out back the way it came (WayBack). It gives up when three
/// plans in a row have brought the robot no nearer. A robot that turns only in curves stays, as does one
/// without LoopRules::go_tight_ways.
/// Threading: one thread owns it.
class GoingBack {
 public:
  GoingBack(const RobotModel& robot, const LoopRules& loop)
      : robot_(robot), may_(loop.go_tight_ways && robot.turns_on_the_spot()) {}

  void Move(const RigidTransform& T_WB) { came_.Note(T_WB); }
  /// Takes note that the robot can go on, or that an operator has decided what it does next.
  void GoesOn();
  /// To where it reaches most of the space in which it fits. @return Nothing if it cannot.
  std::optional<Task> ToMostOfSpace(const RigidTransform& T_WB, const PlanningMap& map,
                                    const TaskMaker& make);
  /// To where there is a path home. @param home_paths  Found in that map. @return Nothing if it cannot.
  std::optional<Task> ToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                 const HomePaths& home_paths, const TaskMaker& make);
  /// Whether ToPathHome leads anywhere, unless it has given up.
  bool LeadsToPathHome(const RigidTransform& T_WB, const PlanningMap& map, const HomePaths& home_paths) const;

 private:
  std::vector<Eigen::Vector3d> Track(const RigidTransform& T_WB, const PlanningMap& map) const;
  /// [m] Empty if there is none.
  std::vector<Eigen::Vector3d> WayToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                             const HomePaths& home_paths) const;
  std::optional<Task> Along(const std::vector<Eigen::Vector3d>& path_W, const RigidTransform& T_WB,
                            const TaskMaker& make);
  bool gives_up() const;

  RobotModel robot_;
  bool may_;
  FlownPath came_;
  std::optional<double> left_;  ///< [m] Least length of the path so far.
  int in_vain_ = 0;             ///< Plans in a row that were no shorter.
};

}  // namespace thalweg::explorer
