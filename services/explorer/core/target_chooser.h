#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "services/explorer/core/candidate_search.h"
#include "services/explorer/core/errand_planner.h"
#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/going_back.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/shut_ways.h"
#include "services/explorer/core/surface_inspection.h"
#include "services/explorer/core/task_maker.h"
#include "services/explorer/core/tight_ways.h"

namespace thalweg::explorer {

/// Chooses what a robot goes to see: finds the candidates, lets the strategy choose among them, and takes a
/// view for inspecting surface first where the strategy wants that and it is nearer. The exploration ends
/// when no candidate is left, or when the strategy finds none worth its path and what is left is at most 1 %
/// of the border of free space; if it is more, the nearest is next. Where too much stayed unknown for an
/// exploration to be complete because unknown space bars the path that the robot looked into in vain or sees
/// little of, it looks at the nearest of that from near. Where a way is shut that was open, it watches that
/// for a while before the end (ShutWays). Where gaps that only fit between voxels lead to more, it goes
/// through them (FindTightWays). One that is shut in all the same goes back the way it came (GoingBack). What
/// a robot that turns only in curves has no room to turn to is set aside, and it chooses again.
///
/// It ends at once where the strategy says that it does not apply, and a strategy that goes by views says
/// itself when it has come to its end.
/// Threading: one thread owns it.
class TargetChooser {
 public:
  /// Throws std::invalid_argument naming the invalid option.
  TargetChooser(const ExplorerOptions& options, Knowledge& knowledge);

  /// Forgets what was inspected and reached so far, because the map is another; not that it has gone a tight
  /// way, since another map may be of the same place.
  void Reset(Knowledge& knowledge);
  void ShiftTimes(Duration back) { shut_ways_.ShiftTimes(back); }
  /// Chooses by another strategy from now on. Error: there is none of that name, or not for this robot, or it
  /// goes by views and the one at the beginning did not.
  std::optional<Error> UseStrategy(std::string_view name, Knowledge& knowledge);
  /// Chooses by the strategy that another uses, for the same robot.
  void TakeOverFrom(const TargetChooser& other, Knowledge& knowledge);

  /// @param make  For the same robot and map.
  Task Choose(const RigidTransform& T_WB, Time now, const TaskMaker& make, const Mission& mission,
              Knowledge& knowledge, GoingBack& going_back, StageTimings& timings);

  /// The robot did not get to where this task leads.
  void DidNotGetThere(const Task& task, const PlanningMap& map);

  /// The candidates of the last choice, and the space that was found reachable.
  const CandidateSearch& search() const { return search_; }
  const std::string& strategy_name() const { return options_.strategy.name; }
  const Strategy& strategy() const { return *strategy_; }
  Strategy& strategy() { return *strategy_; }
  /// Whether the robot has set out on a tight way and has not reached most of the map again since, so that
  /// what it reached before may be out of reach.
  bool gone_tight_way() const { return gone_tight_way_; }
  void RestoreGoneTightWay(bool gone) { gone_tight_way_ = gone; }
  /// As Strategy::left_out, of all strategies so far.
  std::size_t left_out() const { return left_out_before_ + strategy_->left_out(); }

 private:
  /// What one decision is made from.
  struct Moment {
    const RigidTransform& T_WB;
    Time now;
    const TaskMaker& make;
    const Mission& mission;
    Knowledge& knowledge;
    GoingBack& going_back;
    StageTimings& timings;
    bool finds_itself = false;            ///< Whether the strategy finds its frontiers itself.
    std::optional<Budget> dropped_for{};  ///< The budget for which candidates were left out, if any.
    /// Whether what was out of sight is among the candidates already, as far as it is in sight now.
    bool took_out_of_sight = false;
    bool has_no_room_to_inspect = false;  ///< The nearest of what there is to inspect.

    const PlanningMap& map() const { return knowledge.map(); }
    Eigen::Vector3d p_W() const { return T_WB.translation(); }
    std::optional<Budget> TooFar(const InspectionView& view) const {
      return mission.TooFar(map(), view.length, map().CenterOf(view.place), now);
    }
  };

  Task ChooseAt(Moment moment);
  void Use(ConfiguredStrategy strategy, Knowledge& knowledge);
  /// Takes the candidates of a strategy that finds its frontiers itself. @return Whether it does.
  bool TakeOwnCandidates(const Eigen::Vector3d& p_W, const Knowledge& knowledge);
  Situation Describe(const RigidTransform& T_WB, const Knowledge& knowledge);
  Task Decide(Moment moment);
  Task DecideAmongCandidates(const Moment& moment);
  /// The next task when no candidate is left: inspecting what may be far, or the end.
  Task DecideWithoutCandidates(const Moment& moment);
  /// The next task when the strategy finds no candidate worth its path; nothing if the nearest is.
  std::optional<Task> DecideWithoutWorth(const Moment& moment);
  /// The end that a strategy has come to which goes by views.
  Task EndedBy(const StrategyEnd& end, const Moment& moment) const;
  /// @param choice  Set to the one that was tried last. @return Nothing if there is no room to turn to it.
  std::optional<Task> See(Choice& choice, const Situation& situation, const Moment& moment);
  Task Inspect(const InspectionView& view, const Moment& moment);
  Task DecideWithout(const Choice& choice, const Moment& moment);
  /// Sets a target aside to which the robot has no room to turn.
  static void SetAsideForRoom(const std::vector<VoxelIndex>& target, const Moment& moment);
  /// Looks at what may bar the path to the rest, from as near as can be; nothing if all of it is set aside.
  std::optional<Task> LookAtBar(const std::vector<VoxelIndex>& bars, const Moment& moment);
  /// Goes to see a way that is shut, or watches it; nothing if there is none but those watched in vain.
  std::optional<Task> WatchShutWay(const std::vector<ShutWays::Way>& ways, const Moment& moment);
  /// The ways that are shut, for a strategy that leaves finding frontiers to us.
  std::vector<ShutWays::Way> FindShutWays(const Moment& moment) const;
  /// The tight ways, likewise.
  std::vector<TightWay> FindTightWays(const Moment& moment) const;
  /// Goes the first tight way on which the robot keeps its clearance; nothing if there is none.
  std::optional<Task> GoTightWay(const std::vector<TightWay>& ways, const Moment& moment);
  /// The end, unless too much stayed unknown and what bars the path to it can still be looked at, or a way is
  /// to be watched.
  Task EndOrLookAtBar(const Moment& moment);
  Task EndedShutIn(const Moment& moment) const;
  /// As SurfaceInspection::Next, timed.
  std::optional<InspectionView> NextInspection(const std::optional<VoxelIndex>& frontier,
                                               const Moment& moment);

  ExplorerOptions options_;
  CandidateSearch search_;
  ShutWays shut_ways_;
  bool gone_tight_way_ = false;
  /// [m] From where the robot last tried again what it had no room to turn to from elsewhere.
  std::optional<Eigen::Vector3d> tried_again_W_;
  ErrandPlanner looks_;  ///< At what shuts a way.
  std::unique_ptr<Strategy> strategy_;
  std::size_t left_out_before_ = 0;  ///< By strategies before it.
  bool gets_views_;                  ///< Whether there are views, see Strategy::goes_by_views.
  SurfaceInspection inspection_;
};

}  // namespace thalweg::explorer
