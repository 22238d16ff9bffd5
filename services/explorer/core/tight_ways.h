#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// A way to something left to see through a gap that paths from voxel to voxel cannot pass: its middle is not
/// the center of a voxel, or it is narrower than the body with its safety margin.
struct TightWay {
  Eigen::Vector3d place_W{0, 0, 0};  ///< [m] Where it leaves what the robot can reach.
  double area = 0.0;                 ///< [m^2] Frontiers that can only be seen by it.
  Cluster nearest = {};              ///< The nearest of these to which there is a path.
  /// [m] From the robot to where that is seen, in its clearance from all that is not free; empty: only the
  /// body without its margin fits, or the robot could not go on from there.
  std::vector<Eigen::Vector3d> path_W = {};
};

/// Tight ways: all of them, or some of which at least one has a path. Those near to each other are one.
/// O(voxels of the map's box), and for each way a search near to its path.
/// @param search  Flooded from the robot, at `robot_W`, of which the body has that radius [m].
/// @param extent  [m] See FrontierOptions.
std::vector<TightWay> FindTightWays(const Knowledge& knowledge, const PathSearch& search,
                                    const Eigen::Vector3d& robot_W, double radius, const GoalFinder& goals,
                                    double extent);

}  // namespace thalweg::explorer
