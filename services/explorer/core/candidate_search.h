#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/statistics.h"
#include "common/geometry/map_model.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// Milliseconds by stage of a decision.
using StageTimings = std::map<std::string, TimingStatistics>;

/// Finds what the robot could go and see: floods the space it can reach, clusters the frontier voxels that
/// are not set aside, and finds for each cluster the reachable places that have it in plain sight. Clusters
/// that no place sees are set aside.
/// Threading: one thread owns it.
class CandidateSearch {
 public:
  struct Options {
    FrontierOptions frontier;
    double robot_radius = RobotModel{}.radius;  ///< [m]
    double exemption = 0.3;                     ///< [m] See PathSearch::StartAt.
    double wide_exemption = 1.0;                ///< [m] For a robot that is shut in otherwise.
    double look_range = 3.0;                    ///< [m]
    double voxel_size = MapModel{}.voxel_size;  ///< [m]
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit CandidateSearch(const Options& options);

  /// Searches from the robot's position; with the wide exemption when it is shut in otherwise, and a second
  /// time for clusters that no place saw before, since the map may have changed.
  void Find(const Eigen::Vector3d& p_W, const Mission& mission, Time now, Knowledge& knowledge,
            StageTimings& timings);
  /// Drops the candidates that a budget does not allow to visit. @return that budget, if there is one.
  std::optional<Budget> DropTooFar(const PlanningMap& map, const Mission& mission, Time now);

  const std::vector<Candidate>& candidates() const { return candidates_; }
  const Frontiers& frontiers() const { return frontiers_; }
  const PathSearch& search() const { return search_; }  ///< Flooded from the robot.
  /// Whether less than half of the space that fits the robot was reached.
  bool ShutIn(const PlanningMap& map) const { return search_.reached_count() * 2 < map.traversable_count(); }

 private:
  void FindFrom(const Eigen::Vector3d& p_W, const PathSearch::Exemption& exemption, const Mission& mission,
                Time now, Knowledge& knowledge, StageTimings& timings);
  /// @param must_know_return  Only goals from which a path home is known, for a robot that must return.
  void FindFromPart(const PathSearch::Start& start, bool must_know_return, const Mission& mission, Time now,
                    Knowledge& knowledge, StageTimings& timings);

  Options options_;
  GoalFinder goal_finder_;
  PathSearch search_;
  Frontiers frontiers_;
  std::vector<Candidate> candidates_;
};

}  // namespace thalweg::explorer
