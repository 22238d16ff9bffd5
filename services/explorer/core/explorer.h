#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/map_model.h"
#include "services/explorer/core/candidate_search.h"
#include "services/explorer/core/frontier_report.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/path/path_comfort.h"
#include "services/explorer/core/strategy/registry.h"
#include "services/explorer/core/task.h"

namespace thalweg::explorer {

/// Explores: decides where to look and go until nothing reachable is left to see.
///
/// The rules are the same for every strategy:
///   1. Look around: while a view from here shows enough unknown space never looked at, turn to it. At the
///      start any unknown voxel is enough, since everything may lie behind a gap that seems too small.
///   2. Find the candidates: frontier clusters with the reachable places that have them in plain sight
///      (CandidateSearch).
///   3. The strategy chooses the cluster and the path; the path ends as soon as half of what its goal would
///      show of the cluster is in view, facing it.
///   4. In a narrow passage the robot faces it, and turns first when there is no room for that on the way
///      (narrow_passage.h).
///   5. What was looked at twice and stayed unknown is set aside, with a reason, for a while (LookMemory);
///      another reason is recorded where the sensor had no depth, as at surfaces without texture.
///   6. No candidate left: the end, complete unless too much of what free space ends at was looked at in
///      vain. A robot that is shut in tries to leave first.
/// A robot that knows no free space around it turns on the spot until it sees some. A driving robot explores
/// the band of heights that its body sweeps (PlanningMap) and turns about the vertical only.
/// Threading: one thread owns an explorer. It knows no time but what is passed in.
class Explorer {
 public:
  struct Options {
    double voxel_size = MapModel{}.voxel_size;  ///< [m] Of the map; known once the first update has come.
    std::optional<Eigen::AlignedBox3d> bounds;  ///< [m] Nothing outside is explored.
    std::vector<Eigen::AlignedBox3d> no_go;     ///< [m] Nor inside these, which the robot stays out of.
    RobotModel robot;
    PinholeCamera camera = DepthSensorModel{}.camera;
    double sensor_range = MapModel{}.max_range;  ///< [m] Within which a scan shows what is unknown.
    double safety_margin = 0.05;                 ///< [m] Beyond the robot's radius.
    FrontierOptions frontier;
    DoubtOptions doubt;
    LookMemory::Options memory;
    double look_range = 3.0;  ///< [m] An unknown voxel in view nearer than this was looked at.
    /// A look sensed nothing where less than this share of its part of the image has a depth
    /// (MeasuredShares).
    double min_measured_share = 0.5;
    /// An end at which a greater share of what free space ends at was missed (OpenBorder) is not complete.
    double max_missed_share = 0.15;
    double look_around_min_area = 0.2;        ///< [m^2] Never looked at; makes a view worth a turn.
    double exemption = 0.3;                   ///< [m] Around a robot that stands too near to something.
    double wide_exemption = 1.0;              ///< [m] The same when it is shut in.
    double resolved_share = 0.7;              ///< Of the target, known on the way: plan again.
    std::size_t max_voxels = 50'000'000;      ///< Of the planner's box, about 40 bytes each; see PlanningMap.
    Duration time_budget = Duration::zero();  ///< 0 = none
    double distance_budget = 0.0;             ///< [m] 0 = none
    /// At the end, and as soon as the rest of a budget is needed for it, the robot goes back to its start.
    bool return_home = false;
    double home_margin = 0.15;  ///< Of the length of the path home, kept in reserve.
    PathComfort comfort;
    ConfiguredStrategy strategy = Configure("closest");
  };

  /// Throws std::invalid_argument naming the bad option.
  explicit Explorer(const Options& options);

  /// Forgets the map and everything remembered about it.
  void Reset();
  /// Takes in changes and the scans that made them.
  void Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now);
  /// The robot is there: adds to the distance travelled.
  void Move(const RigidTransform& T_WB) { mission_.Move(T_WB.translation()); }

  /// Whether the map knows free space at the robot: without it there is nothing to decide yet.
  bool KnowsPlace(const RigidTransform& T_WB) const { return knowledge_.KnowsPlace(T_WB); }
  /// Which budget is used up, if one is. Time counts from the first call.
  std::optional<Budget> BudgetSpent(Time now) { return mission_.Spent(now); }
  /// The clock went back by that much: what is remembered stays as old as it was.
  void ShiftTimes(Duration back);

  /// Decides. The robot stands, or can be sent elsewhere from where it is.
  Plan MakePlan(const RigidTransform& T_WB, Time now);
  /// The plan was carried out, and a scan from its end is in the map.
  void Arrived(Time now);
  /// The plan was given up because the robot lost its own place on the way, as it may not next time.
  void GotLost(Time now);
  /// Why the plan that is being carried out should be given up for a new one, if it should.
  std::optional<Interruption> CheckPlan(const RigidTransform& T_WB) const;

  struct Status {
    std::size_t frontiers_left = 0;  ///< Clusters, at the last plan, doubtful ones among them.
    std::size_t frontier_voxels_left = 0;
    std::vector<SetAsideCount> set_aside;
    std::size_t plans = 0;
    double distance = 0.0;                                     ///< [m]
    std::map<std::string, TimingStatistics::Summary> timings;  ///< By stage: frontiers, goals, choice, plan.
  };
  Status status() const;
  std::vector<FrontierReport> frontier_reports() const;
  /// The strategy's path of the last plan [m], before it was shortened and led off walls; empty when the plan
  /// goes nowhere.
  const std::vector<Eigen::Vector3d>& chosen_path_W() const { return task_.choice.path_W; }
  /// The potential that the last choice was made from, if there is one.
  const DenseGrid<float>* field() const { return task_.choice.path_W.empty() ? nullptr : strategy_->field(); }

  const PlanningMap& map() const { return knowledge_.map(); }
  const LookMemory& memory() const { return knowledge_.memory(); }
  const std::vector<Candidate>& candidates() const { return search_.candidates(); }  ///< Of the last plan.

 private:
  /// [m] A path that is being followed is given up when the map makes it narrower than that.
  double least_clearance() const { return options_.robot.radius + 0.5 * options_.safety_margin; }
  double clearance() const { return options_.robot.radius + options_.safety_margin; }

  Plan Explore(const RigidTransform& T_WB, Time now);
  Plan GoHome(const RigidTransform& T_WB);
  Plan LookForSpace(const RigidTransform& T_WB);
  std::optional<Plan> LookAround(const RigidTransform& T_WB);
  Plan GoTo(const Choice& choice, const RigidTransform& T_WB);
  /// Turns to the narrow passage ahead, and keeps the plan to carry out after the turn.
  Plan TurnFirst();
  /// Resumes the plan that was kept, when it still holds.
  bool ResumeAfterTurn(const RigidTransform& T_WB);
  /// A plan along that path, facing so at its end.
  Plan Follow(const std::vector<Eigen::Vector3d>& path_W, const Eigen::Matrix3d& R_WB,
              const RigidTransform& T_WB);
  void AimAt(std::vector<VoxelIndex> target, Plan& plan);

  Options options_;
  Knowledge knowledge_;
  Mission mission_;
  CandidateSearch search_;
  std::unique_ptr<Strategy> strategy_;
  Task task_;
  std::optional<Task> after_turn_;  ///< The robot is turning to the path of this one.
  bool has_left_start_ = false;     ///< The map held a goal to go to.
  std::size_t blind_looks_ = 0;     ///< Since free space was known at the robot.
  Time updated_{};                  ///< The map.
  std::size_t plans_ = 0;
  StageTimings timings_;
};

}  // namespace thalweg::explorer
