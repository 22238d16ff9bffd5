#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/point_cloud.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/inspection.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// A cluster that is visible from at least one position that the robot can reach.
struct Candidate {
  Cluster cluster;
  /// Reached voxels near the cluster with a clear line of sight to part of it; the first is the nearest.
  std::vector<VoxelIndex> goals;
  double length = 0.0;  ///< [m] Length of the shortest path to the first goal.
  /// [m] Path that the robot could cover while it turns to see the cluster, beyond that path; 0 where turning
  /// costs nothing.
  double turn = 0.0;
};

/// The robot, from which prices in time follow.
struct TimedRobot {
  RobotModel model;
  Eigen::Matrix3d R_WB;  ///< Its present orientation.
};

/// The input of a strategy's decision.
struct Situation {
  const PlanningMap& map;
  const PathSearch& search;  ///< Costs and shortest paths from the robot to every voxel that it can reach.
  Eigen::Vector3d robot_W;   ///< [m] Position of the robot.
  double clearance;          ///< [m] Distance that a path keeps from occupied and unknown voxels.
  std::span<const Candidate> candidates;  ///< Never empty.
  const ViewPlanner& views;               ///< The views that the sensor can take, and what they show.
  double sensor_range;                    ///< [m] Range within which a scan reveals unknown voxels.
  double look_range;          ///< [m] Range within which a visible unknown voxel counts as looked at.
  bool pull_straight = true;  ///< Whether paths are straightened, see LoopRules.
  std::optional<TimedRobot> time = {};  ///< Empty where only the path counts.
};

/// What a strategy that finds its frontiers itself finds them in.
struct Surroundings {
  const PlanningMap& map;
  Eigen::Vector3d robot_W;                   ///< [m] Position of the robot.
  double clearance;                          ///< [m] The robot's radius and margin.
  const DenseGrid<std::uint8_t>& set_aside;  ///< Over the map's box; nonzero = no longer a target.
  double min_area;                           ///< [m^2] Smaller components are not worth a visit.
  double radius = 0.0;                       ///< [m] The robot's, without the margin.
  /// For a robot that stands too near to an obstacle, in the order in which to try them.
  std::span<const PathSearch::Exemption> exemptions = {};
  bool pull_straight = true;  ///< As in Situation.
};

/// What the robot's camera has seen.
struct CameraView {
  PointCloud cloud;      ///< Organized, as large as the camera's image.
  PinholeCamera camera;  ///< The one that took it.
  RigidTransform T_WB;   ///< Where the body was then.
  RigidTransform T_BC;
};

/// Why a strategy can go on no longer.
struct StrategyEnd {
  bool completes = false;  ///< Whether nothing is left for it to do; else it is stuck.
  std::string why;
};

/// A strategy's decision: what to look at next, and the path to a position from which it is visible.
struct Choice {
  std::size_t candidate = 0;  ///< Index into Situation::candidates.
  /// [m] Starts at the robot and stays in free space. Empty: nothing left is worth its
  /// path, which ends the exploration if it is little enough; or a strategy that finds its frontiers itself
  /// knows no path to any of them.
  std::vector<Eigen::Vector3d> path_W;
  /// Unknown voxels to look at from the end of the path. Empty = those of the candidate.
  std::vector<VoxelIndex> target = {};
  /// The orientation to look in from the end of the path, which the robot then follows to its end. Empty =
  /// any that shows the target, from the first point of the path that shows enough of it.
  std::optional<Eigen::Matrix3d> R_WB = {};
  /// One score per candidate, larger is better. Only displayed; empty if the strategy computes none.
  std::vector<double> scores = {};
};

/// Chooses where to go next.
///
/// Everything else (map, clearance, views, looking around, setting frontiers aside, the end of the
/// exploration) is the same for all strategies, so that they can be compared. To add a strategy, write a
/// class in a file of its own in this folder and add its line to registry.cpp; see
/// docs/guide/add-a-strategy.md.
/// Threading: one thread owns a strategy. It may keep state between calls.
class Strategy {
 public:
  virtual ~Strategy() = default;
  /// For a strategy that finds its frontiers itself: all of them, as candidates for Choose; none ends the
  /// exploration. For all others nothing: they choose among those of CandidateSearch.
  virtual std::optional<std::vector<Candidate>> FindCandidates(const Surroundings& /*surroundings*/) {
    return std::nullopt;
  }
  /// A place [m] that shows that the strategy does not apply here, where the map knows one: the exploration
  /// then ends. Asked before each choice, also when nothing is left to choose among. The search is flooded
  /// from the robot, but for a strategy that finds its frontiers itself.
  virtual std::optional<Eigen::Vector3d> FindMisfit(const PlanningMap& /*map*/,
                                                    const PathSearch& /*search*/) const {
    return std::nullopt;
  }
  /// Called whenever the explorer needs to choose a cluster.
  virtual Choice Choose(const Situation& situation) = 0;
  /// How surface is to be inspected, for a strategy that wants that, too, and chooses among the candidates of
  /// CandidateSearch; null for all others. The explorer then goes to the first stop of a tour through all
  /// that is open and the chosen frontier, and ends when no view is worth its path any more.
  virtual const InspectionOptions* inspection() const { return nullptr; }
  /// Whether, where time counts, it weighs turns on the spot against everything else; the loop then leaves
  /// looking around to it, but for where the robot starts.
  virtual bool weighs_looks() const { return false; }

  // For a strategy that goes by what its camera saw, and not by what of the map is unknown.

  /// Whether it does. It gets a view before its first choice, and one from the end of each path that it
  /// chose, where the robot has stopped; those on the way are not for it. It finds its candidates itself, and
  /// states paths that need no shaping and the orientation at their end. The loop does nothing on its own
  /// between two of its choices: it neither looks around, nor stops short, nor sets aside.
  virtual bool goes_by_views() const { return false; }
  /// Whether it cannot choose before it is given a view.
  virtual bool lacks_view() const { return false; }
  virtual void See(const CameraView& /*seen*/) {}
  /// Why the exploration ends, where FindCandidates has found none. Nothing: as for all others.
  virtual const std::optional<StrategyEnd>& end() const {
    static const std::optional<StrategyEnd> kNone;
    return kNone;
  }
  /// How many places it would have gone to, had the map allowed it.
  virtual std::size_t left_out() const { return 0; }
  /// What people should be shown of its last decisions; each once.
  virtual std::vector<std::string> TakeNotes() { return {}; }

  /// The potential on which the last choice was based, for display. NaN outside of free space.
  /// Null if there is none.
  virtual const DenseGrid<float>* field() const { return nullptr; }
  /// Explored voxels that the strategy left out of that field, for display.
  virtual std::vector<VoxelIndex> sealed() const { return {}; }
};

/// Index of the candidate with the shortest path, where a turn counts as the path that it costs.
std::size_t NearestCandidate(const Situation& situation);
/// The path straightened with PullStraight, if paths are straightened.
std::vector<Eigen::Vector3d> Straightened(const Situation& situation, std::vector<Eigen::Vector3d> path_W);
/// The shortest path from the robot to a reached voxel [m], straightened.
std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const VoxelIndex& goal);
/// The choice to go to a candidate's first goal on the shortest path.
Choice StraightTo(const Situation& situation, std::size_t candidate);

}  // namespace thalweg::explorer
