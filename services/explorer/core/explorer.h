#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/explorer/core/blind_look.h"
#include "services/explorer/core/errand_planner.h"
#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/frontier_report.h"
#include "services/explorer/core/going_back.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/no_go_boxes.h"
#include "services/explorer/core/remembered_asides.h"
#include "services/explorer/core/target_chooser.h"
#include "services/explorer/core/task_maker.h"

namespace thalweg::explorer {

/// Decides where to look and go until nothing reachable is left to see.
///
/// The rules are the same for every strategy, and each can be switched off (LoopRules):
///   1. Look around: while a view from the present position shows enough unknown space that was never
///      looked at, turn to it. At the start any unknown voxel is enough, since everything may lie behind a
///      gap that seems too small.
///   2. Find the candidates: frontier clusters, with the reachable positions that have a clear line of
///      sight to them (CandidateSearch).
///   3. Let the strategy choose the cluster and the path, or take a view that inspects surface
///      (TargetChooser). Unless the strategy chose the view, too, cut the path where the robot already sees
///      half of what the goal would show of the cluster, and face the cluster there (TaskMaker).
///   4. In narrow passages face the direction of travel; turn before setting out when there is no space to
///      turn on the path (narrow_passage.h).
///   5. Set aside for a while, with a reason, what was looked at twice and stayed unknown (LookMemory).
///      Where the sensor had no depth, as at surfaces without texture, the reason says so.
///   6. End when no candidate is left, or the strategy finds none worth its path and little is left
///      (TargetChooser). The end counts as complete unless too much of the border of free space was looked at
///      in vain. A robot that is shut in first tries to get out, and in the end goes back the way it came.
///
/// A robot that knows no free space around it turns on the spot until it sees some. A driving robot explores
/// the band of heights that its body sweeps (PlanningMap) and turns about the vertical axis only. One that
/// turns only in curves does not look around, keeps to curves in place of rule 4, sets aside what it has no
/// room to turn to, and ends where it knows no free space.
/// Threading: one thread owns an explorer. It knows only the times passed to it, no clock.
class Explorer {
 public:
  using Options = ExplorerOptions;

  /// Throws std::invalid_argument naming the invalid option.
  explicit Explorer(const Options& options);

  /// Forgets the map and everything remembered about it.
  void Reset();
  /// Applies map changes and the scans that caused them.
  void Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now);
  /// Updates the robot's position, which adds to the distance traveled.
  void Move(const RigidTransform& T_WB) {
    mission_.Move(T_WB.translation());
    going_back_.Move(T_WB);
  }

  /// Whether the map knows free space at the robot. Without it there is nothing to decide yet.
  bool KnowsPlace(const RigidTransform& T_WB) const { return knowledge_.KnowsPlace(T_WB); }
  /// The budget that is used up, if any. Time counts from the first call.
  std::optional<Budget> BudgetSpent(Time now) { return mission_.Spent(now); }
  /// Adjusts remembered times after the clock jumped back by `back`, so that ages stay the same.
  void ShiftTimes(Duration back);

  /// Makes a plan for a robot that stands still, or that can be redirected from where it is.
  /// @param speed  [m/s] Speed of a robot that moves along the plan being executed and minimizes time: the
  /// new plan begins with the part of the old one that the robot cannot leave any more. 0 = stands, or the
  /// same.
  Plan MakePlan(const RigidTransform& T_WB, Time now, double speed = 0.0);
  /// The part of the present plan that a robot of that speed [m/s] moves along in any case, until it hears of
  /// a new plan and can leave this one, at whose end it can stop. Empty if it stands; nothing if it cannot be
  /// given a new plan while it moves, or that part is not clear.
  std::optional<std::vector<RigidTransform>> PathUntilReplanned(const RigidTransform& T_WB,
                                                                double speed) const;
  /// Takes note of how long a decision in flight took from the pose that it began with [s]: later ones begin
  /// as far ahead as the robot gets meanwhile. Without it they expect Options::decision_time, which is also
  /// the least.
  void NoteDecisionTime(double seconds);
  /// Makes a plan to carry out an errand, unless something comes first: a spent budget, the way home, the
  /// path out of a no-go box. Error: as CheckErrand; there is no plan then.
  Result<Plan> MakePlanFor(const Errand& errand, const RigidTransform& T_WB, Time now);
  /// To be called when the plan has been executed and a scan from its end is in the map.
  /// @param seen  A view from there, if AwaitsView.
  void Arrived(Time now, const CameraView* seen = nullptr);
  /// Whether the strategy needs a view of the camera to decide, and it has to.
  bool AwaitsView() const { return targets_.strategy().goes_by_views() && !mission_.homeward(); }
  /// Takes the first view, unless the strategy has one.
  void See(const CameraView& seen);
  /// To be called when the plan was abandoned because the robot got lost, or its controller does not go on,
  /// which need not happen on a second try.
  void DidNotGetThere(Time now);
  /// Why the plan being executed should be replaced by a new one, if it should.
  std::optional<Interruption> CheckPlan(const RigidTransform& T_WB) const;

  // What an operator may change. An Error says why nothing was changed.

  /// Drops the plan that is kept for after a turn, so that the next plan is a new decision.
  void Abandon();
  /// Why an errand cannot be carried out from here, if it cannot.
  std::optional<Error> CheckErrand(const Errand& errand, const RigidTransform& T_WB, Time now);
  /// Ends the exploration: from now on every plan leads home.
  std::optional<Error> SendHome(const RigidTransform& T_WB);
  /// As RememberedAsides.
  Result<Cluster> Ignore(const Eigen::Vector3d& p_W, Time now) {
    return asides_.Ignore(p_W, options_.frontier, knowledge_, now);
  }
  /// Whether the plan being executed, or kept for after a turn, is for a frontier that is ignored.
  bool AimsAtIgnored() const;
  /// Adds a no-go box. A robot that it covers leaves it with its next plan, and no path enters it again.
  std::optional<Error> DrawNoGo(const Eigen::AlignedBox3d& box_W, const RigidTransform& T_WB);
  void ClearDrawnNoGo() { no_go_.ClearDrawn(knowledge_); }
  /// Takes over the mission and what an operator commanded from an explorer that this one replaces.
  void TakeOverFrom(const Explorer& other);
  /// Decides by another strategy from the next plan on.
  std::optional<Error> UseStrategy(std::string_view name) { return targets_.UseStrategy(name, knowledge_); }
  /// Adds what the next process needs to continue, should this one die.
  void SaveTo(SavedExploration& saved, Time now) const;
  /// Continues what an earlier process saved. Before the first map.
  void Restore(const SavedExploration& saved);

  /// What an operator may have changed, and what a restart must not lose at any time, as it stands.
  struct Standing {
    std::string strategy;                          ///< Name of the one that decides.
    bool homeward = false;                         ///< Whether every plan leads home, for whatever reason.
    bool gone_tight_way = false;                   ///< See TargetChooser::gone_tight_way.
    std::size_t ignored = 0;                       ///< Voxels.
    std::vector<Eigen::AlignedBox3d> drawn_no_go;  ///< [m] Without those of the options.
    bool in_no_go = false;                         ///< Whether the robot has yet to leave a no-go box.
  };
  Standing standing() const;

  struct Status {
    std::size_t frontiers_left = 0;  ///< Clusters at the last plan, including doubtful ones.
    std::size_t frontier_voxels_left = 0;
    std::vector<SetAsideCount> set_aside;
    std::size_t plans = 0;
    std::size_t left_out = 0;  ///< Places where the strategy would have looked, had the map allowed it.
    double distance = 0.0;     ///< [m]
    /// By stage: frontiers, goals, choice, plan.
    std::map<std::string, TimingStatistics::Summary> timings;
  };
  Status status() const;
  std::size_t plans() const { return plans_; }                   ///< Made so far.
  bool planned_in_flight() const { return planned_in_flight_; }  ///< The last one.
  std::vector<FrontierReport> frontier_reports() const;
  /// The strategy's path of the last plan [m], before it was cut short and moved away from walls; empty when
  /// the plan goes nowhere.
  const std::vector<Eigen::Vector3d>& chosen_path_W() const { return task_.choice.path_W; }
  /// The voxels that the plan being executed is to show.
  const std::vector<VoxelIndex>& target() const { return task_.target; }
  /// The potential field on which the last choice was based, if any.
  const DenseGrid<float>* field() const {
    return task_.choice.path_W.empty() ? nullptr : targets_.strategy().field();
  }
  /// Explored voxels that were left out of it.
  std::vector<VoxelIndex> sealed() const { return targets_.strategy().sealed(); }

  const PlanningMap& map() const { return knowledge_.map(); }
  const LookMemory& memory() const { return knowledge_.memory(); }

 private:
  bool minimizes_time() const { return options_.minimize == Minimize::kTime; }
  TaskMaker maker() const { return {options_, knowledge_, lead_ ? &*lead_ : nullptr}; }

  /// Where a robot can leave the plan being executed; empty if it stands, or there is no such place.
  std::optional<Task::Departure> DepartureOf(const RigidTransform& T_WB, double speed) const;
  double DecidesWithin() const;                     ///< [s] Until a decision begun now reaches the robot.
  double SpeedIn(double time, double speed) const;  ///< [m/s] At most, and no less than it is.
  /// What leads to where a robot of that speed [m/s] leaves the plan being executed.
  TaskMaker::Lead LeadOf(const Task::Departure& departure, double speed) const;
  /// Begins a plan. @return The pose to plan from.
  RigidTransform BeginPlan(const RigidTransform& T_WB_reported, Time now);
  /// What comes before any choice, if anything does.
  std::optional<Task> Duty(const RigidTransform& T_WB, Time now);
  Task Explore(const RigidTransform& T_WB, Time now);
  Plan FinishPlan(Task task, double milliseconds);
  /// The path out of the no-go boxes that the robot stands in; an ending when there is none.
  Task LeaveNoGo(const RigidTransform& T_WB);
  Task GoHome(const RigidTransform& T_WB, Time now);
  Task LookForSpace(const RigidTransform& T_WB);
  /// The kept plan, if it is still valid.
  std::optional<Task> ResumeAfterTurn(const RigidTransform& T_WB);
  /// Whether so much of the target is known that another is worth more.
  bool TargetIsSeen() const;

  Options options_;
  Knowledge knowledge_;
  Mission mission_;
  GoingBack going_back_;
  TargetChooser targets_;
  ErrandPlanner errands_;
  BlindLook blind_look_;
  NoGoBoxes no_go_;
  RememberedAsides asides_;
  bool map_is_new_ = false;  ///< The next update is a whole map.
  Task task_;
  /// To where the plan being made begins; empty if the robot is there.
  std::optional<TaskMaker::Lead> lead_;
  std::optional<Task> after_turn_;  ///< The task to resume after the present turn.
  double decision_time_;            ///< [s] The next decision is expected to take so long.
  bool has_left_start_ = false;     ///< Whether the map has held a goal yet.
  Time updated_{};                  ///< Time of the last map update.
  bool planned_in_flight_ = false;
  std::size_t plans_ = 0;
  StageTimings timings_;
};

}  // namespace thalweg::explorer
