#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "common/geometry/map_model.h"
#include "services/explorer/core/candidate_search.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/loop_rules.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/no_go_boxes.h"
#include "services/explorer/core/path/home_paths.h"
#include "services/explorer/core/path/path_comfort.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/shut_ways.h"
#include "services/explorer/core/strategy/registry.h"

namespace thalweg::explorer {

/// What an exploration is to take little of.
enum class Minimize {
  /// Every decision is made standing, and a turn in place costs nothing. That of a robot that turns only in
  /// curves costs as much as these.
  kPath,
  /// Decisions are made in flight, from where the robot can leave its path, and turns count as the path that
  /// they cost.
  kTime,
};

struct ExplorerOptions {
  double voxel_size = MapModel{}.voxel_size;  ///< [m] The map's; known once the first update has come.
  std::optional<Eigen::AlignedBox3d> bounds;  ///< [m] Nothing outside is explored.
  /// [m] The robot stays out of these, and nothing inside is explored.
  std::vector<Eigen::AlignedBox3d> no_go;
  RobotModel robot;
  PinholeCamera camera = DepthSensorModel{}.camera;
  double sensor_range = MapModel{}.max_range;  ///< [m] Within which a scan shows what is unknown.
  double safety_margin = 0.05;                 ///< [m] Beyond the robot's radius.
  FrontierOptions frontier;
  DoubtOptions doubt;
  LookMemory::Options memory;
  double look_range = 3.0;  ///< [m] A look covers the unknown voxels in view within this distance.
  /// A look at a voxel sensed nothing when less than this share of the surrounding part of the image has a
  /// depth (MeasuredShares).
  double min_measured_share = 0.5;
  /// An end is not complete when a greater share of the border of free space was missed (OpenBorder).
  double max_missed_share = 0.15;
  /// [m^2] Unknown area never looked at that makes a view worth a turn.
  double look_around_min_area = 0.2;
  /// [m] Around a robot that stands too near to an obstacle; see PathSearch::StartAt.
  double exemption = PathSearch::Exemption{}.reach;
  /// [m] Likewise when the robot is shut in.
  double wide_exemption = HomePaths::Options{}.wide_exemption;
  /// The robot watches a way that was open and is shut for so long before it ends without what is behind it.
  Duration shut_way_patience = std::chrono::seconds(30);
  double resolved_share = 0.7;  ///< Replan when this share of the target has become known along the path.
  /// Limit on the planner's box, about 40 bytes per voxel; see PlanningMap.
  std::size_t max_voxels = PlanningMap::Options{}.max_voxels;
  Duration time_budget = Duration::zero();  ///< 0 = none.
  double distance_budget = 0.0;             ///< [m] 0 = none.
  /// Whether the robot returns to its start at the end, and as soon as the rest of a budget is needed for
  /// that.
  bool return_home = false;
  /// Share of the length of the path home, kept in reserve.
  double home_margin = HomePaths::Options{}.margin;
  PathComfort comfort;
  LoopRules loop;
  Minimize minimize = Minimize::kPath;
  /// [s] Until a decision made on the fly has reached the controller, unless longer ones are known (see
  /// Explorer::NoteDecisionTime).
  double decision_time = 0.2;
  ConfiguredStrategy strategy = Configure("cover");
  /// Configures a strategy that is chosen while the robot explores. Throws std::invalid_argument for an
  /// unknown name.
  std::function<ConfiguredStrategy(std::string_view name)> configure = Configure;

  /// [m] Distance that paths keep from what is not known to be free.
  double clearance() const { return robot.radius + safety_margin; }
  /// [m] A path being followed is abandoned when the map makes it narrower than this.
  double least_clearance() const { return robot.radius + 0.5 * safety_margin; }
};

/// Throws std::invalid_argument naming the option that is invalid.
void Check(const ExplorerOptions& options);

/// The options with those that the loop's rules switch off.
ExplorerOptions WithLoopRules(ExplorerOptions options);

/// Widens the exemption for a driving robot. Its camera cannot see the floor around its feet where it starts,
/// and it must cross this blind zone to reach space that it has seen.
ExplorerOptions ReachingBeyondItsFeet(ExplorerOptions options);

// What the parts of an explorer use of its options.
Knowledge::Options KnowledgeOptions(const ExplorerOptions& options);
CandidateSearch::Options SearchOptions(const ExplorerOptions& options);
Mission::Options MissionOptions(const ExplorerOptions& options);
NoGoBoxes::Options NoGoOptions(const ExplorerOptions& options);
ShutWays::Options ShutWayOptions(const ExplorerOptions& options);

}  // namespace thalweg::explorer
