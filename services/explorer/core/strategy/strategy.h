#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
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
/// of exploration) is the same for all strategies, so that they can be compared. To add one: derive, and add
/// it to the table in strategy.cpp. Threading: one thread owns a strategy; it may keep what it knows from
/// call to call.
class Strategy {
 public:
  virtual ~Strategy() = default;
  virtual Choice Choose(const Situation& situation) = 0;
  /// What the last choice was made from, for people: a potential over free space, NaN elsewhere; or none.
  virtual const DenseGrid<float>* field() const { return nullptr; }
};

/// The switches of Laplace's equation as a strategy; see potential.h. The defaults are the thesis's method.
struct PotentialOptions {
  enum class Cluster : std::uint8_t {
    kStreamline,     ///< Where the streamline of steepest descent from the robot ends.
    kFlux,           ///< The one into which most flows.
    kFluxPerLength,  ///< Most flux per metre of shortest path.
  };
  enum class Way : std::uint8_t {
    kStreamline,  ///< Along that streamline; only with Cluster::kStreamline.
    kShortest,
    kTraceBack,  ///< The streamline of steepest ascent from the cluster to the robot.
  };
  double source_radius = 0.0;       ///< [m] Of the source about the robot; 0 = the robot's voxel.
  double screening_length = 0.0;    ///< [m] 0 = none
  double relative_residual = 1e-6;  ///< At which the solver stops.
  Cluster cluster = Cluster::kStreamline;
  Way way = Way::kStreamline;
  bool seal = false;  ///< Explored dead ends are walls to the solver: faster, and hardly another field.
};

/// Of information_gain and weighted_information_gain.
struct GainOptions {
  double sample_share = 0.05;  ///< Of the voxels that can be reached, so many are candidate places.
  double decay = 0.2;          ///< [1/m] weighted: a gain A at a path length L counts A exp(-decay L).
};

/// Of flow.
struct FlowOptions {
  double eagerness = 3.0;    ///< [m] of tour accepted to have all that there is to see one metre earlier
  double hysteresis = 0.02;  ///< A tour must be shorter by that share to replace the one before.
  /// [m/m^2] of tour that a frontier in sight of the first stop is worth, where the rest of its own stop is
  /// not in sight.
  double sight_worth = 2.0;
};

struct StrategyOptions {
  std::string name = "closest";
  std::uint32_t seed = 1;  ///< random
  PotentialOptions potential = {};
  GainOptions gain = {};
  FlowOptions flow = {};
};

/// Throws std::invalid_argument, listing the names there are, for an unknown one, and naming a bad option.
std::unique_ptr<Strategy> MakeStrategy(const StrategyOptions& options);

/// The candidate at the end of the shortest path.
std::size_t NearestCandidate(const Situation& situation);
/// The shortest path to a reached voxel, pulled straight.
std::vector<Eigen::Vector3d> ShortestPath(const Situation& situation, const VoxelIndex& goal);
/// Going to a candidate's first goal on the shortest path.
Choice StraightTo(const Situation& situation, std::size_t candidate);

}  // namespace thalweg::explorer
