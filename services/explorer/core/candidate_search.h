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
#include "services/explorer/core/view/goal_memory.h"

namespace thalweg::explorer {

/// Times [ms] by stage of a decision.
using StageTimings = std::map<std::string, TimingStatistics>;

/// Finds what the robot could go and see: floods the space that it can reach, clusters the frontier voxels
/// that are not set aside, and finds for each cluster the reachable positions with a clear line of sight to
/// it. Clusters that no position sees are set aside.
/// Threading: one thread owns it.
class CandidateSearch {
 public:
  struct Options {
    FrontierOptions frontier;
    double robot_radius;    ///< [m]
    double exemption;       ///< [m] See PathSearch::StartAt.
    double wide_exemption;  ///< [m] For a robot that is shut in otherwise.
    double look_range;      ///< [m]
    double voxel_size;      ///< [m]
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit CandidateSearch(const Options& options);

  /// Searches from the robot's position. Repeats the search with the wide exemption when the robot is
  /// otherwise shut in, and where nothing is found otherwise, for clusters that no position saw earlier.
  void Find(const Eigen::Vector3d& p_W, const Mission& mission, Time now, Knowledge& knowledge,
            StageTimings& timings);
  /// Searches again for what no position saw earlier, if anything, because the map may have changed since.
  /// @return Whether a position sees some of it now.
  bool FindOutOfSight(const Eigen::Vector3d& p_W, const Mission& mission, Time now, Knowledge& knowledge,
                      StageTimings& timings);
  /// Searches again, and also for clusters that are too small to matter otherwise.
  void FindSmallest(const Eigen::Vector3d& p_W, const Mission& mission, Time now, Knowledge& knowledge,
                    StageTimings& timings);
  /// Takes candidates that a strategy has found itself.
  void Take(std::vector<Candidate> candidates);
  /// Sets what turning to see each candidate costs. @param price  [m] double(const Candidate&)
  template <class Price>
  void PriceTurns(Price&& price) {
    for (Candidate& candidate : candidates_) candidate.turn = price(candidate);
  }
  /// Drops the candidates for which that holds. @param is_dropped  bool(const Candidate&). @return How many.
  template <class IsDropped>
  std::size_t Drop(IsDropped&& is_dropped) {
    return std::erase_if(candidates_, is_dropped);
  }
  /// Drops the candidates that a budget does not allow to visit. @return The budget that dropped one, if any.
  std::optional<Budget> DropTooFar(const PlanningMap& map, const Mission& mission, Time now);

  /// What is set aside as out of sight although the robot could see it if the unknown space were free into
  /// which it looked in vain, or of which it sees too little to look: space without a measurement, as that
  /// beyond the range of a sensor, may bar the path to whole rooms.
  struct Hidden {
    std::size_t voxels = 0;
    std::vector<VoxelIndex>
        bars;  ///< Where paths to places that see it first leave what the robot can reach.
  };
  /// O(voxels of the map's box), seconds for the largest maps.
  Hidden FindHidden(const Knowledge& knowledge) const;

  const std::vector<Candidate>& candidates() const { return candidates_; }
  const Frontiers& frontiers() const { return frontiers_; }
  const PathSearch& search() const { return search_; }  ///< Flooded from the robot.

 private:
  void FindFrom(const Eigen::Vector3d& p_W, const PathSearch::Exemption& exemption, const Mission& mission,
                Time now, Knowledge& knowledge, StageTimings& timings);
  /// @param must_know_return  For a robot that must return: only accept goals with a known path home.
  void FindFromPart(const PathSearch::Start& start, bool must_know_return, const Mission& mission, Time now,
                    Knowledge& knowledge, StageTimings& timings);

  Options options_;
  GoalMemory goals_;
  PathSearch search_;
  PathSearch::Exemption exemption_;  ///< The last search had this one.
  Frontiers frontiers_;
  std::vector<Candidate> candidates_;
};

}  // namespace thalweg::explorer
