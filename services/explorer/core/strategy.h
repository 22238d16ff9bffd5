#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/explorer/core/frontier.h"
#include "services/explorer/core/path_search.h"

namespace thalweg::explorer {

/// A cluster that can be seen from somewhere the robot can go.
struct Candidate {
  Cluster cluster;
  std::vector<VoxelIndex> goals;  ///< Reached voxels near the cluster with some of it in plain sight; the
                                  ///< first is the nearest to the robot.
  double length = 0.0;            ///< [m] of the shortest path to the first goal
};

/// All that a strategy may look at.
struct Situation {
  const PlanningMap& map;
  const PathSearch& search;  ///< Flooded from the robot: costs and shortest paths to all it can reach.
  Eigen::Vector3d robot_W;   ///< [m]
  double clearance;          ///< [m] that a path keeps from occupied and unknown voxels
  std::span<const Candidate> candidates;  ///< At least one.
};

/// What a strategy decides: which cluster, and the way there.
struct Choice {
  std::size_t candidate = 0;
  std::vector<Eigen::Vector3d> path_W;  ///< [m] from the robot to a goal of the candidate, within free space
  double field_ms = 0.0;                ///< Of it, time spent on a potential field.
};

/// Chooses where to go next. Everything else (map, clearance, views, looking around, setting aside, the end
/// of exploration) is the same for all strategies, so that they can be compared. To add one: derive, and add
/// it to the table in MakeStrategy. Threading: one thread owns a strategy; it may keep what it knows from
/// call to call.
class Strategy {
 public:
  virtual ~Strategy() = default;
  virtual Choice Choose(const Situation& situation) = 0;
};

struct StrategyOptions {
  std::string name = "closest";
  double source_radius = 0.3;       ///< [m] potential: of the source about the robot
  double screening_length = 0.0;    ///< [m] potential: 0 = none
  double relative_residual = 1e-6;  ///< potential
};

/// Throws std::invalid_argument, listing the names there are, for an unknown one.
std::unique_ptr<Strategy> MakeStrategy(const StrategyOptions& options);

/// The shortest path to a candidate's first goal, pulled straight.
std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const Candidate& candidate);

}  // namespace thalweg::explorer
