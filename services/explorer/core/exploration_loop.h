#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "services/explorer/core/command.h"
#include "services/explorer/core/explorer.h"
#include "services/explorer/core/scan_pace.h"

namespace thalweg::explorer {

/// An update from the mapper.
struct MapNews {
  bool replaced = false;    ///< `changes` is a whole map that replaces the old one.
  double voxel_size = 0.0;  ///< [m]
  std::vector<VoxelChange> changes = {};
  std::vector<ScanView> scans = {};  ///< The scans that the update includes.
  Time stamp = {};                   ///< Time of the newest included scan.
};

/// A view of the camera.
struct ViewNews {
  CameraView view;
  Time stamp = {};
};

/// The controller's report on a path.
struct MotionNews {
  Time path_id = {};
  bool done = false;     ///< The robot stands at the end of the path.
  bool stopped = false;  ///< The robot stands before the end of the path,
  bool blocked = false;  ///< because something is in the way, or it does not move although it should.
  bool standing = false;
  double speed = 0.0;  ///< [m/s]
  Time stamp = {};
};

enum class LoopState : std::uint8_t { kWaiting, kLooking, kPlanning, kMoving, kPaused, kDone };

/// What is missing before a plan can be made.
enum class Awaited : std::uint8_t {
  kNothing,
  // Before the first plan:
  kMap,
  kOdometry,
  kScan,
  kNextScan,  ///< Later: none has reached the map for a while.
  kView,      ///< From the camera, for a strategy that goes by views: the first, or one from where it is.
};

/// Executes the explorer's plans one after another: waits until the robot has arrived and a scan from its new
/// pose is in the map, plans, and sends a path. It interrupts a plan, stops and replans when the map makes
/// the path unsafe, when the target has been seen early, when the controller cannot continue, when scans no
/// longer reach the map (ScanPace), or when the robot was lost and has recovered. A robot that can be given a
/// new plan while it moves goes on meanwhile; if its path is blocked, to where it can stop and no further.
///
/// Other services may come and go: a new mapper sends a whole map, a new controller takes up the path that is
/// repeated to it, and a clock that jumps back makes the loop stop and replan.
///
/// An operator may pause, steer and end the exploration (command.h). A paused loop sends a stop and makes no
/// plans; time budgets go on.
/// Threading: one thread owns a loop; Think() is the only call that takes long.
class ExplorationLoop {
 public:
  /// Throws std::invalid_argument naming the invalid option. The voxel size is later taken from the map.
  explicit ExplorationLoop(const Explorer::Options& options);

  /// Returns an error, and changes nothing, when the options make no sense with the map's voxel size.
  [[nodiscard]] std::optional<Error> OnMap(const MapNews& news, Time now);
  void OnPose(const RigidTransform& T_WB);
  /// Keeps the newest view, if the strategy goes by views. Returns an error, and changes nothing, if the view
  /// is not one of a camera, or of another one than those before.
  [[nodiscard]] std::optional<Error> OnView(ViewNews news);
  void OnMotion(const MotionNews& news, Time now);
  /// Sets whether the odometry has lost the robot's pose. The loop replans when the pose is known again.
  void OnTracking(bool lost, Time now);

  /// Carries out a command, or refuses it with a reason and changes nothing.
  Answer Obey(const Command& command, Time now);

  /// What the next process needs to continue, should this one die. An exploration that has ended is saved as
  /// a paused one, so that the robot does not set out again.
  SavedExploration Save(Time now) const;
  /// Continues what an earlier process saved. Before anything else.
  void Restore(const SavedExploration& saved);

  /// See Explorer::NoteDecisionTime.
  void NoteDecisionTime(double seconds) { explorer_.NoteDecisionTime(seconds); }

  /// Does whatever is due. Returns true when the order or the state has changed.
  bool Think(Time now);

  /// A path for the controller, to be repeated until there is another one.
  struct Order {
    Time id;                            ///< Increases with each order.
    std::vector<RigidTransform> T_WBs;  ///< Empty = stop.
  };
  const std::optional<Order>& order() const { return order_; }
  LoopState state() const;
  /// While the robot is paused: why.
  const PauseCause& pause_cause() const { return pause_cause_; }
  const Plan& plan() const { return plan_; }  ///< The last one made.
  Awaited awaited() const;
  /// Number of interrupted plans by reason.
  const std::map<Interruption, std::size_t>& interruptions() const { return interruptions_; }
  const std::optional<Interruption>& last_interruption() const { return last_interruption_; }
  /// Number of plans interrupted because continuing would have been dangerous.
  std::size_t replans() const;
  const Explorer& explorer() const { return explorer_; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kExecuting, kSettling, kStopping, kDone };
  enum class Mode : std::uint8_t {
    kExploring,
    kStepping,  ///< Pauses once the present decision has been carried out.
    kErrand,    ///< Carries out errand_, then pauses.
    kPaused,
  };
  Answer Carry(const command::Pause& pause, Time now);
  Answer Carry(const command::Resume& resume, Time now);
  Answer Carry(const command::Step& step, Time now);
  Answer Carry(const command::Stop& stop, Time now);
  Answer Carry(const command::GoHome& home, Time now);
  Answer Carry(const command::Run& run, Time now);
  Answer Carry(const command::Ignore& ignore, Time now);
  Answer Carry(const command::DrawNoGo& draw, Time now);
  Answer Carry(const command::ClearNoGo& clear, Time now);
  Answer Carry(const command::UseStrategy& use, Time now);
  /// Why the robot cannot be sent anywhere now; empty if it can.
  std::string WhyNotMovable() const;
  /// Replaces the plan being executed, if any: stops the robot, and plans once it stands still.
  void Redirect(Time now);
  /// Stops the robot, and makes no more plans.
  void Pause(PauseCause cause, Time now);
  /// Whether a plan that is due is not made, because the robot is, or now becomes, paused.
  bool Pauses(Time now);
  void MakePlan(Time now);
  void NoteArrival(Time now);
  void End(Time now);
  void Send(std::vector<RigidTransform> T_WBs, Time now);
  /// Stops the robot, and replans once it stands still.
  void Interrupt(Interruption why, Time now);
  void Count(Interruption why);
  /// As Explorer::PathUntilReplanned, if a plan may be replaced for that reason without stopping the robot
  /// first.
  std::optional<std::vector<RigidTransform>> GoesOnAfter(Interruption why) const;
  bool ReadyToPlan() const;
  /// Whether the strategy cannot decide before it has another view.
  bool LacksView() const;
  /// The newest view, if it was taken since the robot arrived last; else null.
  const CameraView* ViewFromHere() const;
  /// Whether the robot would not see where it goes. One that only scans at the ends of its paths never does.
  bool Blind(Time now) const;
  void FollowClock(Time now);

  Explorer::Options options_;
  Explorer explorer_;
  std::optional<RigidTransform> T_WB_;
  std::optional<ViewNews> view_;  ///< The newest.
  double speed_ = 0.0;            ///< [m/s] Last reported.
  bool has_map_ = false;
  bool has_scan_ = false;  ///< The map contains a scan, or is known to.
  ScanPace pace_;
  Phase phase_ = Phase::kWaiting;
  LoopState state_ = LoopState::kWaiting;
  std::optional<Order> order_;
  Plan plan_;
  std::map<Interruption, std::size_t> interruptions_;
  std::optional<Interruption> last_interruption_;
  Mode mode_ = Mode::kExploring;
  bool decided_ = false;  ///< When stepping: whether the decision has been made.
  std::optional<Errand> errand_;
  PauseCause pause_cause_;
  bool plan_due_ = false;
  bool arrived_ = false;  ///< The plan that is due follows an arrival.
  bool changed_ = false;
  bool lost_ = false;
  Time now_;                           ///< Newest time received.
  Time sent_at_;                       ///< When the order was sent.
  Time arrived_at_;                    ///< Scans from then on show the view from the end of the path.
  std::optional<Time> stopped_since_;  ///< Since when the controller has been stopped before the end.
};

}  // namespace thalweg::explorer
