#pragma once

#include <span>
#include <vector>

#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/view.h"

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
  const ViewPlanner& views;               ///< What the sensor shows in which direction.
  double sensor_range;                    ///< [m] within which the sensor tells what is unknown
  double look_range;                      ///< [m] within which an unknown voxel in sight counts as looked at
};

/// What a strategy decides: what to see next, and the way to a place from which it is seen.
struct Choice {
  std::size_t candidate = 0;
  std::vector<Eigen::Vector3d> path_W;  ///< [m] from the robot on, within free space
  std::vector<VoxelIndex> target = {};  ///< Unknown voxels to be seen from there; empty: the candidate's.
  std::vector<double> scores =
      {};  ///< Of each candidate, larger is better, for people; empty: it gives none.
};

/// Chooses where to go next. Everything else (map, clearance, views, looking around, setting aside, the end
/// of exploration) is the same for all strategies, so that they can be compared. To add one: a file of its
/// own in this folder, and its line in registry.cpp. Threading: one thread owns a strategy; it may keep what
/// it knows from call to call.
class Strategy {
 public:
  virtual ~Strategy() = default;
  virtual Choice Choose(const Situation& situation) = 0;
  /// What the last choice was made from, for people: a potential over free space, NaN elsewhere; or none.
  virtual const DenseGrid<float>* field() const { return nullptr; }
};

/// The candidate at the end of the shortest path.
std::size_t NearestCandidate(const Situation& situation);
/// The shortest path to a reached voxel, pulled straight.
std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const VoxelIndex& goal);
/// Going to a candidate's first goal on the shortest path.
Choice StraightTo(const Situation& situation, std::size_t candidate);

}  // namespace thalweg::explorer
