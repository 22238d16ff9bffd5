#pragma once

#include <optional>
#include <vector>

#include "common/geometry/flown_path.h"
#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/task_maker.h"

namespace thalweg::explorer {

/// Leads a robot to which the map shows no way out back the way it came (WayBack). It gives up when three
/// plans in a row have brought the robot no nearer. A robot that turns only in curves stays, as does one
/// without LoopRules::go_tight_ways, but for watching a way home that is shut.
/// Threading: one thread owns it.
class GoingBack {
 public:
  explicit GoingBack(const ExplorerOptions& options);

  void Move(const RigidTransform& T_WB) { came_.Note(T_WB); }
  /// Adjusts remembered times after the clock jumped back by `back`.
  void ShiftTimes(Duration back);
  /// Takes note that the robot can go on, or that an operator has decided what it does next.
  void GoesOn();
  /// To where it reaches most of the space in which it fits. @return Nothing if it cannot.
  std::optional<Task> ToMostOfSpace(const RigidTransform& T_WB, const PlanningMap& map,
                                    const TaskMaker& make);
  /// To where there is a path home; where the way is shut, as far as it leads, to watch for a while whether
  /// it is opened (ExplorerOptions::shut_way_patience). @param home_paths  Found in that map. @return Nothing
  /// if it cannot, or has watched for so long.
  std::optional<Task> ToPathHome(const RigidTransform& T_WB, Time now, const PlanningMap& map,
                                 const HomePaths& home_paths, const TaskMaker& make);
  /// Whether it leads to a path home, unless it has given up.
  bool LeadsToPathHome(const RigidTransform& T_WB, const PlanningMap& map, const HomePaths& home_paths) const;

 private:
  std::vector<Eigen::Vector3d> Track(const RigidTransform& T_WB, const PlanningMap& map) const;
  /// [m] Empty if there is none.
  std::vector<Eigen::Vector3d> WayToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                             const HomePaths& home_paths) const;
  std::optional<Task> Along(const std::vector<Eigen::Vector3d>& path_W, Purpose purpose,
                            const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB, const TaskMaker& make);
  /// Goes to where the way is shut, and watches it.
  std::optional<Task> Watch(const RigidTransform& T_WB, Time now, const PlanningMap& map,
                            const TaskMaker& make);

  double radius_;  ///< [m]
  bool may_;
  Duration patience_;
  FlownPath came_;
  std::optional<double> left_;  ///< [m] Least length of the path so far.
  int in_vain_ = 0;             ///< Plans in a row that were no shorter.
  std::optional<Time> watches_since_;
};

}  // namespace thalweg::explorer
