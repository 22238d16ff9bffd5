#include "services/evaluator/core/lockstep.h"

#include <algorithm>

#include "services/controller/core/retreat.h"
#include "services/simulator/core/depth_sensor.h"

namespace thalweg::evaluator {
namespace {

constexpr double kReversalWay = 0.5;      // [m] Over which the direction of travel is taken.
constexpr double kReversalCosine = -0.5;  // More than 120 degrees off it.
constexpr double kLostForGood = 30.0;     // [s]

class Run {
 public:
  Run(const simulator::World& world, const RigidTransform& T_WB_start, const LockstepOptions& options,
      mapper::OccupancyMap& map, const simulator::TrueMap* truth)
      : world_(world),
        options_(options),
        map_(map),
        truth_(truth),
        sensor_(options.sensor, options.noise_seed, /*colors=*/false),
        explorer_(options.explorer),
        T_WB_(T_WB_start),
        T_WB_true_(T_WB_start),
        start_height_(T_WB_start.translation().z()),
        travelled_W_(T_WB_start.translation()),
        distant_W_(T_WB_start.translation()) {
    if (options.own_pose)
      own_pose_.emplace(*options.own_pose, options.robot.T_BC, T_WB_start, options.noise_seed);
  }

  LockstepResult Explore(const PlanObserver& observe) {
    LookWhenDue();
    Scan();
    while (Seconds() < options_.max_duration && !options_.stop.stop_requested()) {
      const explorer::Plan plan = explorer_.MakePlan(T_WB_, now_);
      if (observe) observe(plan, explorer_, T_WB_);
      if (plan.kind == explorer::Plan::Kind::kDone) {
        result_.stop_reason = plan.stop_reason;
        break;
      }
      if (plan.kind == explorer::Plan::Kind::kGo) CountReversal(plan);
      if (!Follow(plan)) {
        if (lost_ && !FindBack()) break;
        continue;
      }
      Scan();
      explorer_.Arrived(now_);
    }
    if (result_.stop_reason.empty()) {
      result_.stop_reason = Seconds() < options_.max_duration ? kInterrupted : "cut off";
    }
    result_.duration = Seconds();
    result_.explorer = explorer_.status();
    if (own_pose_) result_.own_pose = own_pose_->figures();
    return std::move(result_);
  }

 private:
  double Seconds() const { return thalweg::Seconds(now_.time_since_epoch()); }

  void Scan() {
    const RigidTransform T_WC = T_WB_ * options_.robot.T_BC;
    const PointCloud cloud = sensor_.Capture(world_, T_WB_true_ * options_.robot.T_BC);
    const auto changes = map_.Integrate(cloud, T_WC);
    for (const VoxelChange& change : changes) {
      if (!explorer_.map().InBounds(change.voxel)) continue;
      if (explorer_.map().State(change.voxel) != VoxelState::kUnknown) continue;
      ++known_;
      if (truth_ != nullptr && truth_->Observable(change.voxel)) ++observed_;
    }
    const ScanView scan{.T_WC = T_WC, .measured = MeasuredShares::Of(cloud)};
    explorer_.Update(changes, {&scan, 1}, now_);
    ++result_.scans;
    last_scan_ = now_;
    result_.samples.push_back({Seconds(), result_.distance, T_WB_true_.translation(), known_, observed_});
  }

  /// Whether the robot is where it was to go, and turned as it was to be, as it believes.
  struct Reached {
    bool place = false;
    bool orientation = false;
  };

  /// One time step towards a pose.
  Reached StepTowards(const RigidTransform& goal) {
    const double step = options_.time_step;
    const RigidTransform before = T_WB_;
    const Eigen::Vector3d way = goal.translation() - T_WB_.translation();
    const double travel = std::min(way.norm(), options_.robot.max_speed * step);
    if (way.norm() > 0.0) T_WB_.translation() += way.normalized() * travel;
    T_WB_ = TurnedTowards(T_WB_, goal, options_.robot.max_turn_rate * step);
    if (own_pose_) {
      T_WB_true_ = T_WB_true_ * (before.inverse() * T_WB_);
      // What it believes of its height and tilt does not lift its wheels.
      if (options_.robot.drives) T_WB_true_ = InPlane(T_WB_true_, start_height_);
    } else {
      T_WB_true_ = T_WB_;
    }
    now_ += FromSeconds(step);
    result_.distance += travel;
    if ((T_WB_.translation() - travelled_W_).norm() >= kReversalWay) {
      distant_W_ = travelled_W_;
      travelled_W_ = T_WB_.translation();
    }
    explorer_.Move(T_WB_);
    Touch(travel);
    const Reached reached{(goal.translation() - T_WB_.translation()).norm() < 1e-9,
                          AngleBetween(T_WB_, goal) <= 1e-6};
    if (!lost_) retreat_.Note(T_WB_);
    LookWhenDue();
    return reached;
  }

  /// Where the robot believes itself to be, by the frame of this moment, when one is due.
  void LookWhenDue() {
    if (!own_pose_ || !own_pose_->Due(now_)) return;
    const std::optional<RigidTransform> T_WB = own_pose_->Look(world_, T_WB_true_, now_);
    lost_ = !T_WB;
    if (T_WB) T_WB_ = *T_WB;
  }

  /// Goes back the way it came until there is a pose. False when there is none for too long.
  bool FindBack() {
    const Time since = now_;
    while (lost_) {
      if (thalweg::Seconds(now_ - since) > kLostForGood) {
        result_.stop_reason = "lost";
        return false;
      }
      StepTowards(retreat_.Back(T_WB_, options_.time_step).value_or(T_WB_));
    }
    explorer_.GotLost(now_);
    return true;
  }

  /// @param travel  [m] since the last time.
  void Touch(double travel) {
    clearance_ -= travel;  // at least so much is left
    if (clearance_ > 0.0 && clearance_ > result_.least_clearance) return;
    clearance_ = world_.ClearanceOf(options_.robot, T_WB_true_.translation(), 1.0);
    result_.least_clearance = std::min(result_.least_clearance, clearance_);
    if (clearance_ < 0.0 && !touching_) ++result_.collisions;
    touching_ = clearance_ < 0.0;
  }

  void CountReversal(const explorer::Plan& plan) {
    const Eigen::Vector3d before = T_WB_.translation() - distant_W_;
    Eigen::Vector3d ahead = Eigen::Vector3d::Zero();
    for (const RigidTransform& waypoint : plan.T_WBs) {
      ahead = waypoint.translation() - T_WB_.translation();
      if (ahead.norm() >= kReversalWay) break;
    }
    if (ahead.norm() < kReversalWay || before.norm() < kReversalWay) return;
    if (before.normalized().dot(ahead.normalized()) < kReversalCosine) ++result_.reversals;
  }

  /// False when the plan was given up on the way.
  bool Follow(const explorer::Plan& plan) {
    for (const RigidTransform& waypoint : plan.T_WBs) {
      while (!StepTowards(waypoint).place) {
        if (!GoesOn()) return false;
      }
    }
    bool turned = AngleBetween(T_WB_, plan.T_WBs.back()) <= 1e-6;
    while (!turned) {
      turned = StepTowards(plan.T_WBs.back()).orientation;
      if (!GoesOn()) return false;
    }
    return !lost_;
  }

  /// Scans when that is due. Whether the plan still holds.
  bool GoesOn() {
    if (lost_) return false;
    if (thalweg::Seconds(now_ - last_scan_) < 1.0 / options_.sensor.rate - 1e-9) return true;
    Scan();
    const auto interruption = explorer_.CheckPlan(T_WB_);
    if (interruption && interruption->unsafe) ++result_.replans;
    return !interruption;
  }

  const simulator::World& world_;
  const LockstepOptions& options_;
  mapper::OccupancyMap& map_;
  const simulator::TrueMap* truth_;
  simulator::DepthSensor sensor_;
  explorer::Explorer explorer_;
  std::optional<OwnPose> own_pose_;
  bool lost_ = false;
  controller::Retreat retreat_{{}};
  RigidTransform T_WB_;  ///< As the robot believes.
  RigidTransform T_WB_true_;
  double start_height_;          ///< [m]
  Eigen::Vector3d travelled_W_;  ///< [m] Last place a good way from the one before, distant_W_.
  Eigen::Vector3d distant_W_;
  Time now_{};
  Time last_scan_{};
  double clearance_ = 0.0;  ///< [m] At least that; exact when it counts.
  bool touching_ = false;
  std::size_t known_ = 0;
  std::size_t observed_ = 0;
  LockstepResult result_;
};

}  // namespace

LockstepResult RunLockstep(const simulator::World& world, const RigidTransform& T_WB_start,
                           const LockstepOptions& options, mapper::OccupancyMap& map,
                           const PlanObserver& observe, const simulator::TrueMap* truth) {
  return Run(world, T_WB_start, options, map, truth).Explore(observe);
}

}  // namespace thalweg::evaluator
