#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "services/explorer/core/explorer.h"

namespace thalweg::explorer {

/// What came from the mapper.
struct MapNews {
  bool replaced = false;    ///< `changes` is a whole map, on which nothing of the old one stands.
  double voxel_size = 0.0;  ///< [m]
  std::vector<VoxelChange> changes = {};
  std::vector<ScanView> scans = {};  ///< Those inside.
  Time stamp = {};                   ///< Of the newest scan inside.
};

/// What the controller says of a path.
struct MotionNews {
  Time path_id = {};
  bool done = false;     ///< Stands at the path's end.
  bool stopped = false;  ///< Stands before it.
  bool standing = false;
  Time stamp = {};
};

enum class LoopState : std::uint8_t { kWaiting, kLooking, kPlanning, kMoving, kDone };

/// What is missing before the first plan.
enum class Awaited : std::uint8_t { kNothing, kMap, kOdometry, kScan };

/// Carries out the explorer's plans one after the other: waits until the robot has arrived and a scan from
/// there is in the map, plans, and sends a path. It interrupts a plan, stops and plans again when the map
/// makes the path unsafe, when the target was seen on the way, when the controller cannot go on, or when the
/// robot got lost and was found.
///
/// Services may come and go: a new mapper brings a whole map, a new controller takes up the path it hears,
/// and a clock that goes back makes the loop stop and plan again.
/// Threading: one thread owns a loop; Think() is the only call that takes long.
class ExplorationLoop {
 public:
  /// Throws std::invalid_argument naming the bad option. The map's voxel size is taken from the news.
  explicit ExplorationLoop(const Explorer::Options& options);

  /// Error, and nothing taken: a map with which the options make no sense.
  [[nodiscard]] std::optional<Error> OnMap(const MapNews& news, Time now);
  void OnPose(const RigidTransform& T_WB);
  void OnMotion(const MotionNews& news, Time now);
  /// Whether the odometry has lost the robot's place. The loop plans again when the place is known again.
  void OnTracking(bool lost, Time now);

  /// Does what is due. True when the order or the state has changed.
  bool Think(Time now);

  /// What the controller shall follow, again and again, until there is another.
  struct Order {
    Time id;                            ///< Grows with each order.
    std::vector<RigidTransform> T_WBs;  ///< Empty = stop.
  };
  const std::optional<Order>& order() const { return order_; }
  LoopState state() const { return state_; }
  const Plan& plan() const { return plan_; }  ///< The last one made.
  Awaited awaited() const;
  /// How often plans were interrupted, by reason.
  const std::map<Interruption, std::size_t>& interruptions() const { return interruptions_; }
  const std::optional<Interruption>& last_interruption() const { return last_interruption_; }
  /// Plans that were interrupted because going on would have been dangerous.
  std::size_t replans() const;
  const Explorer& explorer() const { return explorer_; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kExecuting, kSettling, kStopping, kDone };
  void MakePlan(Time now);
  void Send(std::vector<RigidTransform> T_WBs, Time now);
  /// Stops the robot, and plans when it stands.
  void Interrupt(Interruption why, Time now);
  void Count(Interruption why);
  bool ReadyToPlan() const;
  void FollowClock(Time now);

  Explorer::Options options_;
  Explorer explorer_;
  std::optional<RigidTransform> T_WB_;
  bool has_map_ = false;
  bool has_scan_ = false;  ///< In that map, or known to be.
  Phase phase_ = Phase::kWaiting;
  LoopState state_ = LoopState::kWaiting;
  std::optional<Order> order_;
  Plan plan_;
  std::map<Interruption, std::size_t> interruptions_;
  std::optional<Interruption> last_interruption_;
  bool plan_due_ = false;
  bool arrived_ = false;  ///< The plan that is due follows an arrival.
  bool changed_ = false;
  bool lost_ = false;
  Time now_;                           ///< Newest that was heard of.
  Time sent_at_;                       ///< The order.
  Time arrived_at_;                    ///< Scans from then on show what is to be seen from the path's end.
  std::optional<Time> stopped_since_;  ///< By the controller, before the end.
};

}  // namespace thalweg::explorer
