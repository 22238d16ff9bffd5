#include "services/evaluator/core/lockstep.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>

#include "common/base/check.h"
#include "common/geometry/attitude.h"
#include "common/voxel/dense_grid.h"
#include "common/voxel/moved_grid.h"
#include "services/controller/core/retreat.h"
#include "services/evaluator/core/contact_meter.h"
#include "services/evaluator/core/run_sensor.h"
#include "services/mapper/core/cloud_filter.h"

namespace thalweg::evaluator {
namespace {

constexpr double kHeadingLength = 0.5;    // [m] over which the heading of travel is measured
constexpr double kReversalCosine = -0.5;  // a turn by more than 120 degrees
constexpr double kLostForGood = 30.0;     // [s]

std::unique_ptr<controller::MotionController> ControllerOf(controller::ControllerType type,
                                                           const RobotModel& robot) {
  controller::PathFollower::Options options;
  options.robot = robot;
  options.emergency_factor = 1.0;
  // Nothing is lost on the way; a shorter silence than it takes to brake would keep the robot from its speed.
  options.silence = options.cut_off.after = 3600.0;
  return controller::MakeController(type, options);
}

RigidTransform StartOf(const RobotModel& robot, const RigidTransform& T_WB) {
  return robot.gimballed() ? Held(robot, T_WB) : T_WB;
}

class Run {
 public:
  Run(const simulator::World& world, const RigidTransform& T_WB_start, const LockstepOptions& options,
      mapper::FusedMap& map, const simulator::TrueMap* truth, const ScanObserver& observe_scan,
      const CloudObserver& observe_cloud)
      : own_world_(world.parts().empty() ? std::nullopt : std::optional(world.AtStart())),
        world_(own_world_ ? *own_world_ : world),
        options_(options),
        filter_(mapper::MakeFilter(options.filter)),
        map_(map),
        truth_(truth),
        observe_scan_(observe_scan),
        observe_cloud_(observe_cloud),
        sensor_(options.sensor, options.stereo, options.noise_seed, options.colors),
        contacts_(world_, options.robot),
        motion_(StartOf(options.robot, T_WB_start)),
        loop_(options.explorer),
        T_WB_(StartOf(options.robot, T_WB_start)),
        T_WB_true_(T_WB_),
        start_height_(T_WB_start.translation().z()),
        traveled_W_(T_WB_start.translation()),
        distant_W_(T_WB_start.translation()) {
    if (options.motion == MotionModel::kDynamic) {
      if (options.own_pose) throw std::invalid_argument("dynamic motion needs the true pose");
      controller_ = ControllerOf(options.controller, options.robot);
    }
    if (options.own_pose) own_pose_.emplace(*options.own_pose, options.robot.T_BC, T_WB_, options.noise_seed);
  }

  LockstepResult Explore(const PlanObserver& observe) {
    TakeMap({.replaced = true, .voxel_size = options_.mapper.voxel_size, .stamp = now_});
    LookWhenDue();
    loop_.OnPose(T_WB_);
    Scan();
    while (Seconds() < options_.max_duration && !options_.stop.stop_requested()) {
      const bool ordered = loop_.Think(now_);
      const bool done = loop_.state() == explorer::LoopState::kDone;  // perhaps since it was last asked
      if ((ordered || done) && observe) observe(loop_.plan(), loop_.explorer(), T_WB_);
      if (done) {
        // One that was flying when the last decision was made has yet to come to a stand.
        while (speed_ > 0.0) Lead();
        break;
      }
      if (ordered && loop_.plan().kind == explorer::Plan::Kind::kGo) CountReversal(loop_.plan());
      if (controller_ != nullptr) {
        Lead();
        continue;
      }
      if (Follow(*loop_.order())) {
        const Time id = loop_.order()->id;
        loop_.OnMotion({.path_id = id, .done = true, .standing = true, .stamp = now_}, now_);
        if (std::exchange(arrived_at_, id) != id || ScanIsDue()) Scan();
        continue;
      }
      if (lost_ && !FindBack()) break;
      loop_.OnMotion({.path_id = loop_.order()->id, .standing = true, .stamp = now_}, now_);
    }
    result_.end = End();
    result_.duration = Seconds();
    result_.explorer = loop_.explorer().status();
    result_.replans = loop_.replans();
    result_.motion = motion_.figures();
    result_.collisions = contacts_.collisions();
    result_.least_clearance = contacts_.least_clearance();
    if (own_pose_) result_.own_pose = own_pose_->figures();
    return std::move(result_);
  }

 private:
  double Seconds() const { return thalweg::Seconds(now_.time_since_epoch()); }

  RunEnd End() const {
    if (loop_.state() == explorer::LoopState::kDone) {
      return {.kind = RunEnd::Kind::kExplorer, .ending = *loop_.plan().ending};
    }
    if (lost_for_good_) return {.kind = RunEnd::Kind::kLost};
    if (Seconds() >= options_.max_duration) return {.kind = RunEnd::Kind::kCutOff};
    return {.kind = RunEnd::Kind::kInterrupted};
  }

  void TakeMap(const explorer::MapNews& news) {
    const std::optional<Error> error = loop_.OnMap(news, now_);
    THALWEG_CHECK(!error);  // the map has the voxel size of the options
  }

  void Scan() {
    const RigidTransform T_WC = T_WB_ * options_.robot.T_BC;
    const RigidTransform T_WC_true = T_WB_true_ * options_.robot.T_BC;
    PointCloud cloud = sensor_.Capture(world_, T_WC_true);
    if (observe_cloud_) observe_cloud_(cloud, T_WC, T_WC_true);
    if (loop_.explorer().AwaitsView()) {
      const std::optional<Error> error =
          loop_.OnView({.view = {cloud, sensor_.camera(), T_WB_, options_.robot.T_BC}, .stamp = now_});
      THALWEG_CHECK(!error);  // the cloud is of the sensor's camera
    }
    if (filter_) filter_->Apply(cloud);
    const std::span<const VoxelChange> changes = map_.Integrate(cloud, T_WC);
    explorer::MapNews news{.voxel_size = options_.mapper.voxel_size,
                           .changes = {changes.begin(), changes.end()},
                           .scans = {{.T_WC = T_WC, .measured = MeasuredShares::Of(cloud)}},
                           .stamp = now_};
    TakeMap(news);
    CountKnown(news.changes);
    ++result_.scans;
    last_scan_ = now_;
    result_.samples.push_back({Seconds(), result_.distance, T_WB_true_.translation(), known_, observed_});
    if (observe_scan_) observe_scan_(result_.samples.back(), loop_.explorer());
  }

  /// Whether the robot has reached a goal pose, according to its own pose estimate.
  struct Reached {
    bool place = false;
    bool orientation = false;
  };

  /// Moves one time step toward a pose.
  Reached StepTowards(const RigidTransform& goal) {
    const double step = options_.time_step;
    if (!options_.robot.turns_on_the_spot()) return SteerTowards(goal);
    const Eigen::Vector3d offset_W = goal.translation() - T_WB_.translation();
    const bool turns_first = options_.robot.faces_travel() && AngleBetween(T_WB_, goal) > 1e-6;
    const double travel = turns_first ? 0.0 : std::min(offset_W.norm(), options_.robot.max_speed * step);
    RigidTransform next = T_WB_;
    if (offset_W.norm() > 0.0) next.translation() += offset_W.normalized() * travel;
    return Place(TurnedFor(options_.robot, next, goal, step), travel, goal);
  }

  /// The same along the chord of a curve, which takes as long as the way or the turn. Only an estimate that
  /// has jumped makes such a robot turn without a way.
  Reached SteerTowards(const RigidTransform& goal) {
    const RobotModel& robot = options_.robot;
    const double way = (goal.translation() - T_WB_.translation()).norm();
    const double turn = AngleBetween(T_WB_, goal);
    const double takes = std::max(way / robot.max_speed, turn / robot.max_turn_rate);
    const double share = takes > options_.time_step ? options_.time_step / takes : 1.0;
    return Place(Interpolate(T_WB_, goal, share), share * way, goal);
  }

  /// Ends a time step in which the robot went to a pose, by its own estimate. @param travel  [m]
  Reached Place(const RigidTransform& T_WB, double travel, const RigidTransform& goal) {
    const RigidTransform before = std::exchange(T_WB_, T_WB);
    if (own_pose_) {
      T_WB_true_ = T_WB_true_ * (before.inverse() * T_WB_);
      // An error in the estimated height or tilt neither lifts wheels off the ground nor tilts a level body.
      if (options_.robot.drives) {
        T_WB_true_ = InPlane(T_WB_true_, start_height_);
      } else {
        T_WB_true_ = Held(options_.robot, T_WB_true_);
      }
    } else {
      T_WB_true_ = T_WB_;
    }
    now_ += FromSeconds(options_.time_step);
    Moved(travel);
    const Reached reached{(goal.translation() - T_WB_.translation()).norm() < 1e-9,
                          AngleBetween(T_WB_, goal) <= 1e-6};
    if (!lost_) retreat_.Note(T_WB_);
    LookWhenDue();
    return reached;
  }

  /// Takes note of a step that was made.
  void Moved(double travel) {
    result_.distance += travel;
    if ((T_WB_.translation() - traveled_W_).norm() >= kHeadingLength) {
      distant_W_ = traveled_W_;
      traveled_W_ = T_WB_.translation();
    }
    loop_.OnPose(T_WB_);
    motion_.Move(T_WB_true_, options_.time_step);
    const Eigen::Vector3d& p_W = T_WB_true_.translation();
    const double approach = own_world_ ? own_world_->MoveParts(options_.time_step, options_.robot, p_W) : 0.0;
    contacts_.Move(p_W, travel + approach);
  }

  /// Counts the voxels of which the mapper reports something for the first time. That the explorer takes the
  /// robot's own space for free is no such report.
  void CountKnown(const std::vector<VoxelChange>& changes) {
    const explorer::PlanningMap& planned = loop_.explorer().map();
    if (!(counted_.box() == planned.box())) counted_ = MovedTo(counted_, planned.box(), std::uint8_t{0});
    for (const VoxelChange& change : changes) {
      if (!planned.InBounds(change.voxel) || !counted_.box().Contains(change.voxel)) continue;
      if (std::exchange(counted_[change.voxel], std::uint8_t{1}) != 0) continue;
      ++known_;
      if (truth_ != nullptr && truth_->Observable(change.voxel)) ++observed_;
    }
  }

  /// Lets the controller lead the robot for one time step.
  void Lead() {
    const explorer::ExplorationLoop::Order& order = *loop_.order();
    controller_->SetPose(T_WB_, now_);
    controller_->SetPath(order.id, order.T_WBs, now_);
    now_ += FromSeconds(options_.time_step);
    const controller::Motion motion = controller_->Step(now_);
    const Eigen::Vector3d before_W = T_WB_.translation();
    if (motion.command) T_WB_ = motion.command->T_WB;
    T_WB_true_ = T_WB_;
    Moved((T_WB_.translation() - before_W).norm());
    speed_ = motion.speed;
    const bool done = motion.state == controller::MotionState::kDone;
    const bool arrives = done && motion.path_id != arrived_at_;
    if (done) arrived_at_ = motion.path_id;
    loop_.OnMotion({.path_id = motion.path_id,
                    .done = done,
                    .stopped = motion.state == controller::MotionState::kStopped,
                    .blocked = motion.reason == controller::StopReason::kThroughSolid ||
                               motion.reason == controller::StopReason::kBlocked,
                    .standing = motion.speed == 0.0 && motion.state != controller::MotionState::kFollowing,
                    .speed = motion.speed,
                    .stamp = now_},
                   now_);
    if (arrives || (ScanIsDue() && options_.explorer.loop.scan_on_the_way)) Scan();
  }

  bool ScanIsDue() const { return thalweg::Seconds(now_ - last_scan_) >= 1.0 / sensor_.rate() - 1e-9; }

  /// Updates the estimated pose from the current frame, if one is due.
  void LookWhenDue() {
    if (!own_pose_ || !own_pose_->Due(now_)) return;
    const std::optional<RigidTransform> T_WB = own_pose_->Look(world_, T_WB_true_, now_);
    lost_ = !T_WB;
    if (T_WB) {
      T_WB_ = *T_WB;
      loop_.OnPose(T_WB_);  // before the loop plans again with a pose that is found
    }
    loop_.OnTracking(lost_, now_);
  }

  /// Retreats until there is a pose again. Returns false when that takes too long or a budget ends the run
  /// meanwhile.
  bool FindBack() {
    const Time since = now_;
    while (lost_) {
      lost_for_good_ = thalweg::Seconds(now_ - since) > kLostForGood;
      if (lost_for_good_) return false;
      StepTowards(retreat_.Back(T_WB_, options_.time_step).value_or(T_WB_));
      loop_.Think(now_);
      if (loop_.state() == explorer::LoopState::kDone) return false;
    }
    return true;
  }

  void CountReversal(const explorer::Plan& plan) {
    const Eigen::Vector3d before = T_WB_.translation() - distant_W_;
    Eigen::Vector3d ahead = Eigen::Vector3d::Zero();
    for (const RigidTransform& waypoint : plan.T_WBs) {
      ahead = waypoint.translation() - T_WB_.translation();
      if (ahead.norm() >= kHeadingLength) break;
    }
    if (ahead.norm() < kHeadingLength || before.norm() < kHeadingLength) return;
    if (before.normalized().dot(ahead.normalized()) < kReversalCosine) ++result_.reversals;
  }

  /// Carries out an order. Returns false when another order replaces it before its end, or the robot is lost.
  bool Follow(const explorer::ExplorationLoop::Order& order) {
    const Time id = order.id;
    const std::vector<RigidTransform> T_WBs = order.T_WBs;
    if (T_WBs.empty()) return false;
    for (const RigidTransform& waypoint : T_WBs) {
      while (!StepTowards(waypoint).place) {
        if (!GoesOn(id)) return false;
      }
    }
    bool turned = AngleBetween(T_WB_, T_WBs.back()) <= 1e-6;
    while (!turned) {
      turned = StepTowards(T_WBs.back()).orientation;
      if (!GoesOn(id)) return false;
    }
    return !lost_;
  }

  /// Scans if a scan is due. Returns whether the order is still current.
  bool GoesOn(Time id) {
    if (lost_) return false;
    if (ScanIsDue() && options_.explorer.loop.scan_on_the_way) Scan();
    if (loop_.order()->id == id) loop_.Think(now_);
    return loop_.order()->id == id;
  }

  std::optional<simulator::World> own_world_;  ///< Where parts move, since others use the world as well.
  const simulator::World& world_;
  const LockstepOptions& options_;
  std::unique_ptr<mapper::CloudFilter> filter_;  ///< Null if nothing is to be dropped.
  mapper::FusedMap& map_;
  const simulator::TrueMap* truth_;
  const ScanObserver& observe_scan_;
  const CloudObserver& observe_cloud_;
  RunSensor sensor_;
  ContactMeter contacts_;
  MotionMeter motion_;
  explorer::ExplorationLoop loop_;
  std::unique_ptr<controller::MotionController> controller_;  ///< For dynamic motion.
  Time arrived_at_{-Duration(1)};  ///< The path at whose end the robot stands, or last stood.
  std::optional<OwnPose> own_pose_;
  bool lost_ = false;
  bool lost_for_good_ = false;
  controller::Retreat retreat_{{}};
  RigidTransform T_WB_;  ///< The robot's estimate.
  RigidTransform T_WB_true_;
  double start_height_;  ///< [m]
  /// [m] Position kHeadingLength or more away from the previous one, distant_W_.
  Eigen::Vector3d traveled_W_;
  Eigen::Vector3d distant_W_;
  Time now_{};
  Time last_scan_{};
  DenseGrid<std::uint8_t> counted_;  ///< Nonzero for the voxels in known_.
  double speed_ = 0.0;               ///< [m/s] As the controller last reported it.
  std::size_t known_ = 0;
  std::size_t observed_ = 0;
  LockstepResult result_;
};

}  // namespace

LockstepResult RunLockstep(const simulator::World& world, const RigidTransform& T_WB_start,
                           const LockstepOptions& options, mapper::FusedMap& map, const PlanObserver& observe,
                           const simulator::TrueMap* truth, const ScanObserver& observe_scan,
                           const CloudObserver& observe_cloud) {
  return Run(world, T_WB_start, options, map, truth, observe_scan, observe_cloud).Explore(observe);
}

}  // namespace thalweg::evaluator
