#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "services/controller/core/controller_type.h"
#include "tests/services/controller/support/poses.h"

/// What tests of the controllers share: a robot that obeys it, and a measure of how smoothly it moves.
namespace thalweg::controller::test {

inline constexpr double kTick = 0.02;  ///< [s]

/// A robot that is at the commanded pose one tick later, or that hears only some commands and moves straight
/// to the last one that it has heard, and a path that is repeated ten times a second.
class Ride {
 public:
  explicit Ride(const RigidTransform& start, const PathFollower::Options& options = {},
                ControllerType type = ControllerType::kPathFollower)
      : Ride(start, MakeController(type, options), options) {}
  /// @param options  Those that the controller has in common with ours.
  Ride(const RigidTransform& start, std::unique_ptr<MotionController> controller,
       const PathFollower::Options& options)
      : options_(options),
        controller_(std::move(controller)),
        robot_(start),
        now_(Time{} + FromSeconds(100.0)) {}

  void Follow(std::vector<RigidTransform> path) {
    path_ = std::move(path);
    id_ = now_;
    heard_path_ = Time{};
  }

  Motion Tick() {
    now_ += FromSeconds(kTick);
    if (path_ && !path_silent && now_ - heard_path_ >= FromSeconds(0.1)) {
      controller_->SetPath(id_, *path_, now_);
      heard_path_ = now_;
    }
    if (!pose_silent) controller_->SetPose(robot_, now_);
    Motion motion = controller_->Step(now_);
    if (motion.command && !stuck) Obey(motion.command->T_WB);
    return motion;
  }

  /// Ticks until `done` and returns the last motion. Fails after `limit` seconds.
  Motion Until(const std::function<bool(const Motion&)>& done, double limit = 120.0) {
    const Time start = now_;
    for (;;) {
      Motion motion = Tick();
      if (done(motion)) return motion;
      if (Seconds(now_ - start) > limit) {
        ADD_FAILURE() << "not reached: " << static_cast<int>(motion.reason);
        return motion;
      }
    }
  }
  Motion UntilDone() {
    return Until([](const Motion& motion) { return motion.state == MotionState::kDone; });
  }

  double now() const { return Seconds(now_.time_since_epoch()); }
  double last_heard() const { return Seconds(heard_path_.time_since_epoch()); }
  RigidTransform& robot() { return robot_; }
  const PathFollower::Options& options() const { return options_; }
  MotionController& controller() { return *controller_; }
  Time time() const { return now_; }

  bool path_silent = false;
  bool pose_silent = false;
  bool stuck = false;
  int hears_every = 1;  ///< The robot hears one of so many commands.

 private:
  void Obey(const RigidTransform& command) {
    if (++commands_ % hears_every == 0) heard_ = command;
    if (!heard_) return;
    const Eigen::Vector3d p_W = robot_.translation();
    const Eigen::Vector3d step = heard_->translation() - p_W;
    const double reach = options_.robot.max_speed * kTick;
    robot_ = *heard_;
    if (step.norm() > reach) robot_.translation() = p_W + step * (reach / step.norm());
  }

  PathFollower::Options options_;
  std::unique_ptr<MotionController> controller_;
  RigidTransform robot_;
  Time now_;
  Time id_;
  Time heard_path_;
  std::optional<std::vector<RigidTransform>> path_;
  int commands_ = 0;
  std::optional<RigidTransform> heard_;
};

/// Velocity and turn rate between the commands of consecutive ticks, and their changes.
class Differences {
 public:
  void Add(const RigidTransform& T_WB) {
    if (last_) {
      const Eigen::Vector3d v = (T_WB.translation() - last_->translation()) / kTick;
      const Eigen::AngleAxisd turn(Eigen::Quaterniond(last_->linear().transpose() * T_WB.linear()));
      const Eigen::Vector3d w = turn.angle() * turn.axis() / kTick;
      speed = std::max(speed, v.norm());
      turn_rate = std::max(turn_rate, w.norm());
      if (v_) {
        speed_step = std::max(speed_step, (v - *v_).norm());
        turn_step = std::max(turn_step, (w - w_).norm());
      }
      v_ = v;
      w_ = w;
    }
    last_ = T_WB;
  }

  double speed = 0.0;
  double turn_rate = 0.0;
  double speed_step = 0.0;
  double turn_step = 0.0;

 private:
  std::optional<RigidTransform> last_;
  std::optional<Eigen::Vector3d> v_;
  Eigen::Vector3d w_ = Eigen::Vector3d::Zero();
};

inline std::vector<RigidTransform> RandomPath(std::mt19937& random, const RigidTransform& start, int corners,
                                              double longest) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<RigidTransform> path{start};
  for (int i = 0; i < corners; ++i) {
    const Eigen::Vector3d step(unit(random), unit(random), unit(random));
    const Eigen::Vector3d p = path.back().translation() + longest * step;
    path.push_back(At(p.x(), p.y(), p.z(), 3.0 * unit(random), 1.5 * unit(random)));
  }
  return path;
}

}  // namespace thalweg::controller::test
