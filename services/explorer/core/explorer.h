#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/statistics.h"
#include "common/base/time.h"
#include "common/geometry/scan_view.h"
#include "services/explorer/core/journey.h"
#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/map/open_border.h"
#include "services/explorer/core/path/path_comfort.h"
#include "services/explorer/core/task.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// Explores: keeps the map, decides where to look and go until nothing reachable is left to see.
///
/// The loop, the same for every strategy:
///   1. look around: while a view from here shows enough unknown never looked at, turn to it; where it starts
///      anything unknown is enough, since all may lie behind a gap that seems too small to matter;
///   2. frontier clusters; a goal for each: the reachable places nearest to it that have it in plain sight;
///   3. the strategy chooses the cluster and the way; the way ends as soon as half of what the goal would
///   show
///      of the cluster is in sight, facing it;
///   4. where the way is narrow the robot faces it, and turns to it first when there is no room for that on
///   the way (narrow_way.h);
///   5. what was looked at twice and stayed unknown is set aside, with a reason, for a while: another one
///   where the sensor had no depth, as before surfaces without texture;
///   6. no goal left: done, and complete unless too much of what the free space ends at was missed. A
///   robot that is shut in first tries to leave.
/// A robot that knows no free space about it turns on the spot until it sees some. One that drives explores
/// the band of heights that its body sweeps (PlanningMap) and turns about the vertical only.
/// Threading: one thread owns an explorer. It knows no time but what is handed in.
class Explorer {
 public:
  struct Options {
    double voxel_size = 0.10;                   ///< [m] Of the map; known once the first update has come.
    std::optional<Eigen::AlignedBox3d> bounds;  ///< [m] Nothing outside is explored.
    std::vector<Eigen::AlignedBox3d> no_go;     ///< [m] Nor inside these, which the robot keeps out of.
    RobotModel robot;
    PinholeCamera camera = DepthSensorModel{}.camera;
    double sensor_range = 5.0;    ///< [m] Within which a scan tells what is unknown.
    double safety_margin = 0.05;  ///< [m] Beyond the robot's radius.
    FrontierOptions frontier;
    DoubtOptions doubt;
    LookMemory::Options memory;
    double look_range = 3.0;  ///< [m] An unknown in view nearer than this was looked at.
    /// Of a cell of the image (MeasuredShares): with less than that measured, a look in its direction sensed
    /// nothing. 0 = that is not asked.
    double min_measured_share = 0.5;
    /// An end at which a greater share of what free space ends at was missed (OpenBorder) is not complete.
    double max_missed_share = 0.15;
    double look_around_min_area = 0.2;        ///< [m^2] So much never looked at makes a view worth a turn.
    double exemption = 0.3;                   ///< [m] About a robot that stands too near to something.
    double wide_exemption = 1.0;              ///< [m] When it is shut in.
    double resolved_share = 0.7;              ///< Of the target, known while on the way: plan anew.
    std::size_t max_voxels = 50'000'000;      ///< Of the planner's box, about 40 bytes each; see PlanningMap.
    Duration time_budget = Duration::zero();  ///< 0 = none
    double distance_budget = 0.0;             ///< [m] 0 = none
    /// At the end, and as soon as what is left of a budget is needed for it, the robot goes back to where it
    /// set out.
    bool return_home = false;
    double home_margin = 0.15;  ///< Of the way home's length, kept in reserve.
    PathComfort comfort;
    StrategyOptions strategy;
  };
  /// Why a run ends in which too much stayed unknown to be called complete.
  static constexpr const char* kTooMuchUnknown = "incomplete: too much stayed unknown";

  /// Throws std::invalid_argument naming the bad option.
  explicit Explorer(const Options& options);

  /// Forgets the map and all that was remembered of it.
  void Reset();
  /// Changes, and the scans that made them.
  void Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now);
  /// The robot is there: sums up the distance travelled.
  void Move(const RigidTransform& T_WB) { journey_.Move(T_WB.translation()); }

  /// Whether the map knows free space about the robot: without it there is nothing to decide yet.
  bool KnowsPlace(const RigidTransform& T_WB) const;
  /// Which budget is used up, when one is. Time counts from the first call.
  std::optional<std::string> BudgetSpent(Time now) { return journey_.Spent(now); }
  /// The clock went back by that much: what is remembered stays as old as it was.
  void ShiftTimes(Duration back);

  /// Decides. The robot stands, or can be sent elsewhere from where it is.
  Plan MakePlan(const RigidTransform& T_WB, Time now);
  /// The plan was carried out and a scan from its end is in the map.
  void Arrived(Time now);
  /// The plan was given up because the robot did not know its own place on the way: as it may not next time.
  void GotLost(Time now);
  /// Why the plan that is being carried out should be given up for a new one, when it should.
  struct Interruption {
    std::string reason;
    bool unsafe = false;  ///< The path ahead is no longer clear: stop first.
  };
  std::optional<Interruption> CheckPlan(const RigidTransform& T_WB) const;

  struct SetAsideCount {
    std::string reason;
    std::size_t clusters = 0;
    std::size_t voxels = 0;
  };
  struct Status {
    std::size_t frontiers_left = 0;  ///< Clusters, at the last plan, doubtful ones among them.
    std::size_t frontier_voxels_left = 0;
    std::vector<SetAsideCount> set_aside;
    std::size_t plans = 0;
    double distance = 0.0;                                     ///< [m]
    std::map<std::string, TimingStatistics::Summary> timings;  ///< By stage: frontiers, goals, choice, plan.
  };
  Status status() const;

  /// A frontier as the last plan saw it.
  enum class Fate : std::uint8_t {
    kLeft,
    kChosen,    ///< Of those left, the one that the plan goes to.
    kSetAside,  ///< See reason.
  };
  struct FrontierReport {
    Eigen::Vector3d center_W{0, 0, 0};  ///< [m]
    std::size_t voxels = 0;             ///< Unknown ones, or doubtful ones: then the reason says so.
    double length = 0.0;                ///< [m] Of the shortest path to where it is seen; NaN when set aside.
    double score = 0.0;                 ///< The strategy's, larger is better; NaN where it gives none.
    Fate fate = Fate::kLeft;
    std::string reason;
  };
  std::vector<FrontierReport> frontier_reports() const;
  /// Of the last plan, the strategy's way [m] before it was shortened and led off walls; empty when it goes
  /// nowhere.
  const std::vector<Eigen::Vector3d>& way_W() const { return task_.choice.path_W; }
  /// The potential that the last choice was made from, when there is one.
  const DenseGrid<float>* field() const { return task_.choice.path_W.empty() ? nullptr : strategy_->field(); }

  const PlanningMap& map() const { return map_; }
  const LookMemory& memory() const { return memory_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }  ///< Of the last plan.

 private:
  /// [m] A path that is being followed is given up when the map makes it narrower than that.
  double least_clearance() const { return options_.robot.radius + 0.5 * options_.safety_margin; }
  double clearance() const { return options_.robot.radius + options_.safety_margin; }
  /// What the map has just changed.
  void TakeIn(std::span<const PlanningMap::StateChange> changes);
  /// A robot that drives is in the plane where it made its first plan, whatever its odometry says.
  void StayInPlane(RigidTransform& T_WB);
  Plan LookForSpace(const RigidTransform& T_WB);
  /// @return which budget keeps the robot from a candidate, when one does.
  std::optional<std::string> LeaveOutTooFar(Time now);
  Plan GoHome(const RigidTransform& T_WB);
  /// What there is to do next, but for going home.
  Plan Explore(const RigidTransform& T_WB, Time now);
  /// Keeps the plan to go for after the robot's turn to its way.
  Plan TurnFirst();
  /// Takes up what was kept when it still holds.
  bool GoOnAfterTurn(const RigidTransform& T_WB);
  std::optional<Plan> LookAround(const RigidTransform& T_WB);
  void FindCandidates(const RigidTransform& T_WB, const PathSearch::Exemption& exemption, Time now);
  /// @param may_not_return  Only goals from which a way home is known, when it must return.
  void FindCandidatesFrom(const PathSearch::Start& start, bool may_not_return, Time now);
  /// A plan along that path, facing so at its end.
  Plan Follow(const std::vector<Eigen::Vector3d>& path_W, const Eigen::Matrix3d& R_WB,
              const RigidTransform& T_WB);
  Plan GoTo(const Choice& choice, const RigidTransform& T_WB);
  /// What a scan had in the direction of a voxel; nothing when that is outside its image, or not known.
  std::optional<Sensed> SensedBy(const ScanView& scan, const VoxelIndex& i) const;
  /// Whether a robot there could have an unknown voxel in view.
  bool Sees(const Eigen::Vector3d& p_W, const VoxelIndex& i) const;
  /// Shortens the way to the first place from which half of what the goal shows of the target is seen.
  void StopWhereSeen(std::vector<Eigen::Vector3d>& path_W, const std::vector<VoxelIndex>& target) const;
  /// What is set aside, by why, what is doubtful apart.
  std::vector<std::pair<std::string, std::vector<VoxelIndex>>> SetAsideByReason() const;
  View ViewOf(const std::vector<VoxelIndex>& target, const Eigen::Vector3d& p_W,
              const Eigen::Matrix3d& R_WB) const;
  Plan Done(const std::string& reason) const;
  /// The end when nothing is left to go to: complete, or not.
  Plan NothingLeft() const;
  bool ShutIn() const { return search_.reached_count() * 2 < map_.traversable_count(); }

  Options options_;
  PlanningMap map_;
  LookMemory memory_;
  ViewPlanner views_;
  std::unique_ptr<Strategy> strategy_;
  GoalFinder goal_finder_;
  PathSearch search_;
  Frontiers frontiers_;
  std::vector<Candidate> candidates_;
  std::optional<RigidTransform> counted_T_WC_;  ///< Of the last scan whose looks were counted.
  std::optional<ScanView> last_scan_;
  bool has_left_start_ = false;  ///< The map held a goal to go to.
  std::size_t blind_looks_ = 0;  ///< Since free space was known about the robot.

  Task task_;
  std::optional<Task> after_turn_;  ///< The robot is turning to the way of this one.

  Journey journey_;
  std::string homeward_;  ///< Why the robot is on its way home; empty: it is not.

  Time updated_{};  ///< The map.
  std::size_t plans_ = 0;
  std::map<std::string, TimingStatistics> timings_;
};

}  // namespace thalweg::explorer
