#include "services/controller/core/path_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace thalweg::controller {
namespace {

constexpr double kTick = 0.02;

RigidTransform At(double x, double y, double z = 0.0, double yaw = 0.0, double pitch = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, pitch), {x, y, z});
}

/// A robot that is at the commanded pose one tick later, and a path that is repeated ten times a second.
class Ride {
 public:
  explicit Ride(const RigidTransform& start, const PathFollower::Options& options = {})
      : follower_(options), robot_(start), now_(Time{} + FromSeconds(100.0)) {}

  void Follow(std::vector<RigidTransform> path) {
    path_ = std::move(path);
    id_ = now_;
    heard_path_ = Time{};
  }

  Motion Tick() {
    now_ += FromSeconds(kTick);
    if (path_ && !path_silent && now_ - heard_path_ >= FromSeconds(0.1)) {
      follower_.SetPath(id_, *path_, now_);
      heard_path_ = now_;
    }
    if (!pose_silent) follower_.SetPose(robot_, now_);
    Motion motion = follower_.Step(now_);
    if (motion.command && !stuck) robot_ = motion.command->T_WB;
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
  PathFollower& follower() { return follower_; }
  Time time() const { return now_; }

  bool path_silent = false;
  bool pose_silent = false;
  bool stuck = false;

 private:
  PathFollower follower_;
  RigidTransform robot_;
  Time now_;
  Time id_;
  Time heard_path_;
  std::optional<std::vector<RigidTransform>> path_;
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

std::vector<RigidTransform> RandomPath(std::mt19937& random, const RigidTransform& start, int corners,
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

TEST(PathFollower, StraightLineTakesTheTimeOfTheTrapezoid) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(2, 0)});
  const double start = ride.now();
  ride.UntilDone();
  EXPECT_NEAR(ride.now() - start, 2.0 / 0.5 + 0.5 / 1.0, 3.0 * kTick);  // L / v + v / a
}

TEST(PathFollower, ShortLineTakesTheTimeOfTheTriangle) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(0.09, 0)});
  const double start = ride.now();
  ride.UntilDone();
  EXPECT_NEAR(ride.now() - start, 2.0 * std::sqrt(0.09 / 1.0), 3.0 * kTick);  // 2 sqrt(L / a)
}

TEST(PathFollower, TurnOnTheSpotTakesTheTimeOfTheTrapezoid) {
  Ride ride(At(1, 1));
  ride.Follow({At(1, 1, 0, 2.5)});
  const double start = ride.now();
  const Motion motion = ride.UntilDone();
  EXPECT_NEAR(ride.now() - start, 2.5 / 1.6 + 1.6 / 4.0, 3.0 * kTick);
  EXPECT_NEAR(AngleBetween(motion.command->T_WB, At(1, 1, 0, 2.5)), 0.0, 1e-6);
}

TEST(PathFollower, StaysOnThePolylineWithinAMicrometre) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    Ride ride(At(0, 0));
    const auto path = RandomPath(random, At(0, 0), 12, 0.4);
    const Track track(path, {});
    ride.Follow(path);
    ride.Until([&](const Motion& motion) {
      EXPECT_LT(track.DistanceTo(motion.command->T_WB.translation(), 0.0, track.length()), 1e-6);
      return motion.state == MotionState::kDone;
    });
    EXPECT_NEAR((ride.robot().translation() - path.back().translation()).norm(), 0.0, 1e-6);
    EXPECT_NEAR(AngleBetween(ride.robot(), path.back()), 0.0, 1e-5);
  }
}

TEST(PathFollower, CommandsNeverExceedSpeedAccelerationAndTurnLimits) {
  std::mt19937 random(4);
  for (int round = 0; round < 40; ++round) {
    Ride ride(At(0, 0));
    ride.Follow(RandomPath(random, At(0, 0), 12, round % 2 == 0 ? 0.8 : 0.1));
    const PathFollower::Options& limits = ride.follower().options();
    Differences differences;
    ride.Until([&](const Motion& motion) {
      differences.Add(motion.command->T_WB);
      return motion.state == MotionState::kDone;
    });
    EXPECT_LE(differences.speed, limits.max_speed + 1e-9);
    EXPECT_LE(differences.turn_rate, limits.max_turn_rate + 1e-9);
    // Where a corner lies within a tick, its velocity step adds to that of the acceleration.
    EXPECT_LE(differences.speed_step, limits.max_acceleration * kTick + limits.corner_step + 1e-9);
    EXPECT_LE(differences.turn_step, limits.max_turn_acceleration * kTick + 1e-6);
  }
}

TEST(PathFollower, VelocityCommandIsTheDerivativeOfThePoseCommand) {
  Ride ride(At(0, 0, 0, 1.0));
  ride.Follow({At(0, 0, 0, 1.0), At(3, 0, 0, 1.0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  const Motion before = ride.Tick();
  const Motion after = ride.Tick();
  const Eigen::Vector3d moved_W = after.command->T_WB.translation() - before.command->T_WB.translation();
  const Eigen::Vector3d v_W = before.command->T_WB.linear() * before.command->v_WB_B;
  EXPECT_NEAR(v_W.x(), moved_W.x() / kTick, 0.02);  // plus a little to catch up with the command
  EXPECT_NEAR(v_W.y(), 0.0, 1e-9);
}

TEST(PathFollower, SilentPathStandsStillWithinHalfASecond) {
  for (const double moment : {0.3, 1.0, 1.7, 3.33}) {
    Ride ride(At(0, 0));
    ride.Follow({At(0, 0), At(10, 0, 0, 3.0)});
    const double start = ride.now();
    ride.Until([&](const Motion&) { return ride.now() - start > moment; });
    ride.path_silent = true;
    ride.Until([&](const Motion&) { return ride.now() - ride.last_heard() >= 0.5 - 1e-9; });
    const RigidTransform then = ride.robot();
    const Motion motion = ride.Until([&](const Motion&) { return ride.now() - ride.last_heard() > 3.0; });
    EXPECT_EQ(motion.state, MotionState::kStopped);
    EXPECT_EQ(motion.reason, StopReason::kPathSilent);
    EXPECT_TRUE(motion.command->v_WB_B.isZero());
    EXPECT_TRUE(motion.command->w_WB_B.isZero());
    EXPECT_TRUE(then.isApprox(motion.command->T_WB, 1e-12));
  }
}

TEST(PathFollower, SilentPoseStandsStillWithinHalfASecond) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(10, 0)});
  const double start = ride.now();
  ride.Until([&](const Motion&) { return ride.now() - start > 2.0; });
  ride.pose_silent = true;
  const double silent = ride.now();
  ride.Until([&](const Motion&) { return ride.now() - silent >= 0.5 - 1e-9; });
  const RigidTransform then = ride.robot();
  const Motion motion = ride.Until([&](const Motion&) { return ride.now() - silent > 3.0; });
  EXPECT_EQ(motion.reason, StopReason::kPoseSilent);
  EXPECT_TRUE(then.isApprox(motion.command->T_WB, 1e-12));
}

TEST(PathFollower, ARobotThatIsLostStopsAndGoesBackWithoutAPose) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.pose_silent = true;
  double farthest = 0.0;
  double last = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    ride.follower().SetLost(true, ride.time());
    const Motion motion = ride.Tick();
    EXPECT_EQ(motion.state, MotionState::kStopped);
    last = ride.robot().translation().x();
    farthest = std::max(farthest, last);
  }
  EXPECT_LT(farthest, 1.15) << "it braked at once";
  EXPECT_NEAR(farthest - last, PathFollower::Options{}.retreat.reach, 0.02);
  // Once found again, the robot continues from where it is.
  ride.follower().SetLost(false, ride.time());
  ride.pose_silent = false;
  const Motion end = ride.UntilDone();
  EXPECT_EQ(end.state, MotionState::kDone);
  EXPECT_NEAR(ride.robot().translation().x(), 5.0, 0.03);
}

TEST(PathFollower, ALostRobotStandsWhenItsExplorerIsSilent) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.pose_silent = true;
  ride.path_silent = true;
  for (int tick = 0; tick < 50; ++tick) {
    ride.follower().SetLost(true, ride.time());
    ride.Tick();
  }
  const double stands = ride.robot().translation().x();
  for (int tick = 0; tick < 50; ++tick) {
    ride.follower().SetLost(true, ride.time());
    ride.Tick();
  }
  EXPECT_EQ(ride.robot().translation().x(), stands);
}

TEST(PathFollower, GoesOnByItselfWhenThePathIsHeardAgain) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(3, 0)});
  Differences differences;
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.path_silent = true;
  ride.Until(
      [&](const Motion& motion) { return motion.state == MotionState::kStopped && motion.speed == 0; });
  ride.path_silent = false;
  const Motion motion = ride.Until([&](const Motion& m) {
    differences.Add(m.command->T_WB);
    return m.state == MotionState::kDone;
  });
  EXPECT_NEAR(motion.distance_done, 3.0, 1e-9);
  EXPECT_LE(differences.speed_step, kTick + 1e-9);
}

PathFollower::Options GoingBack(OnCutOff action) {
  PathFollower::Options options;
  options.cut_off = {.action = action, .after = 4.0, .step = 1.0};
  return options;
}

bool GoesBack(const Motion& motion) {
  return motion.reason == StopReason::kGoingBack;
}
bool WaitsWhereItBegan(const Motion& motion) {
  return motion.reason == StopReason::kWentBack && motion.back == BackPlace::kBeginning;
}

TEST(PathFollower, CutOffFromItsExplorerItGoesBackOnThePathItCameWithinItsLimits) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(2, 0, 0, 1.0), At(2, 3, 0, 2.0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().y() > 1.0; });
  ride.path_silent = true;
  const double heard = ride.last_heard();
  Differences differences;
  const Motion going = ride.Until(GoesBack);
  EXPECT_NEAR(ride.now() - heard, 4.0, 2.0 * kTick);
  EXPECT_EQ(going.state, MotionState::kStopped);
  const double began = ride.now();
  ride.Until([&](const Motion& motion) {
    const Eigen::Vector3d p_W = ride.robot().translation();
    EXPECT_LE(std::min(std::abs(p_W.y()), std::abs(p_W.x() - 2.0)), 0.02) << p_W.transpose();
    differences.Add(motion.command->T_WB);
    return WaitsWhereItBegan(motion);
  });
  const PathFollower::Options limits;
  EXPECT_LE(differences.speed, limits.max_speed + 1e-9);
  EXPECT_LE(differences.turn_rate, limits.max_turn_rate + 1e-6);
  EXPECT_LE(differences.speed_step, limits.max_acceleration * kTick + limits.corner_step + 1e-6);
  EXPECT_LT(ride.robot().translation().norm(), 0.03);
  EXPECT_LT(ride.now() - began, 3.3 / limits.max_speed + 5.0) << "it does not dawdle";
  // Without a word it stays there.
  const RigidTransform there = ride.robot();
  const double waits = ride.now();
  const Motion waiting = ride.Until([&](const Motion&) { return ride.now() - waits > 20.0; });
  EXPECT_TRUE(WaitsWhereItBegan(waiting)) << static_cast<int>(waiting.reason);
  EXPECT_TRUE(ride.robot().isApprox(there, 1e-9));
}

TEST(PathFollower, RetreatsInStepsAndWaitsBetweenThem) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kRetreat));
  ride.Follow({At(0, 0), At(9, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 2.5; });
  ride.path_silent = true;
  const double heard_at = ride.robot().translation().x();
  std::vector<double> waits;
  ride.Until([&](const Motion& motion) {
    const bool waiting = motion.reason == StopReason::kWentBack;
    const double x = ride.robot().translation().x();
    if (waiting && (waits.empty() || std::abs(waits.back() - x) > 0.1)) waits.push_back(x);
    return WaitsWhereItBegan(motion);
  });
  ASSERT_EQ(waits.size(), 4U);
  EXPECT_NEAR(waits[0], heard_at, 0.06);
  EXPECT_NEAR(waits[1], waits[0] - 1.0, 0.04);
  EXPECT_NEAR(waits[2], waits[1] - 1.0, 0.04);
  EXPECT_NEAR(waits[3], 0.0, 0.03);
}

TEST(PathFollower, APathThatIsHeardEndsThePathBackAtOnce) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 2.0; });
  ride.path_silent = true;
  ride.Until([&](const Motion& motion) { return GoesBack(motion) && ride.robot().translation().x() < 1.5; });
  ride.path_silent = false;
  double least = 5.0;
  Differences differences;
  const Motion end = ride.Until([&](const Motion& motion) {
    least = std::min(least, ride.robot().translation().x());
    differences.Add(motion.command->T_WB);
    EXPECT_FALSE(GoesBack(motion)) << "it has heard a path";
    return motion.state == MotionState::kDone;
  });
  EXPECT_GT(least, 1.5 - 0.2) << "it brakes from full speed in 0.125 m";
  const PathFollower::Options limits;
  EXPECT_LE(differences.speed_step, limits.max_acceleration * kTick + limits.corner_step + 1e-6);
  EXPECT_NEAR(ride.robot().translation().x(), 5.0, 0.03);
  EXPECT_EQ(end.reason, StopReason::kNone);
}

TEST(PathFollower, ARobotAtTheEndOfItsPathGoesBackAsWell) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(1, 0)});
  ride.UntilDone();
  ride.path_silent = true;
  ride.Until(WaitsWhereItBegan);
  EXPECT_LT(ride.robot().translation().norm(), 0.03);
}

TEST(PathFollower, OnItsPathBackItStopsWhenItsPoseIsSilentOrLost) {
  for (const bool lost : {false, true}) {
    Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
    ride.Follow({At(0, 0), At(5, 0)});
    ride.Until([&](const Motion&) { return ride.robot().translation().x() > 2.0; });
    ride.path_silent = true;
    ride.Until(
        [&](const Motion& motion) { return GoesBack(motion) && ride.robot().translation().x() < 1.5; });
    ride.pose_silent = true;
    const double x = ride.robot().translation().x();
    for (int tick = 0; tick < 200; ++tick) {
      if (lost) ride.follower().SetLost(true, ride.time());
      ride.Tick();
    }
    EXPECT_NEAR(ride.robot().translation().x(), x, lost ? 0.1 : 0.3);
    EXPECT_EQ(ride.Tick().reason, lost ? StopReason::kLost : StopReason::kPoseSilent);
    ride.pose_silent = false;
    ride.follower().SetLost(false, ride.time());
    ride.Until(WaitsWhereItBegan);
    EXPECT_LT(ride.robot().translation().norm(), 0.03);
  }
}

TEST(PathFollower, ARobotThatIsToStayDoesNotGoBack) {
  Ride ride(At(0, 0), GoingBack(OnCutOff::kHome));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.follower().SetStays(true);
  ride.path_silent = true;
  const double silent = ride.now();
  const Motion motion = ride.Until([&](const Motion&) { return ride.now() - silent > 30.0; });
  EXPECT_EQ(motion.reason, StopReason::kPathSilent);
  EXPECT_GT(ride.robot().translation().x(), 1.0);
}

/// A wall at x = 2 m.
OccupancyGrid WallAhead() {
  OccupancyGrid map(0.1);
  for (int y = -10; y < 10; ++y) {
    for (int z = -10; z < 10; ++z) map.Set({20, y, z}, 2.0F);
  }
  return map;
}

TEST(PathFollower, APathThroughWhatIsKnownToBeSolidIsRefusedAndTheNextOneFollowed) {
  PathFollower::Options options;
  options.checked_body = PathCheck::Body{.radius = 0.1};
  const OccupancyGrid map = WallAhead();
  Ride ride(At(0, 0), options);
  ride.Follow({At(0, 0), At(5, 0)});
  EXPECT_EQ(ride.Until([](const Motion& motion) { return motion.state == MotionState::kStopped; }).reason,
            StopReason::kNoMap);
  ride.follower().SetMap(map);
  const double start = ride.now();
  const Motion refused = ride.Until([&](const Motion&) { return ride.now() - start > 2.0; });
  EXPECT_EQ(refused.state, MotionState::kStopped);
  EXPECT_EQ(refused.reason, StopReason::kThroughSolid);
  ASSERT_TRUE(refused.obstacle_W);
  EXPECT_NEAR(refused.obstacle_W->x(), 2.05, 1e-9);
  EXPECT_LT(ride.robot().translation().norm(), 1e-9);
  ride.Follow({At(0, 0), At(1.5, 0)});
  ride.UntilDone();
  EXPECT_NEAR(ride.robot().translation().x(), 1.5, 0.03);
}

TEST(PathFollower, StopsBeforeAWallThatBecomesKnownOnTheWayAndGoesOnWhenItIsGone) {
  PathFollower::Options options;
  options.checked_body = PathCheck::Body{.radius = 0.1};
  OccupancyGrid map(0.1);
  Ride ride(At(0, 0), options);
  ride.follower().SetMap(map);
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.7; });
  map = WallAhead();
  ride.follower().SetMap(map);
  const Motion stopped = ride.Until(
      [&](const Motion& motion) { return motion.state == MotionState::kStopped && motion.speed == 0.0; });
  EXPECT_EQ(stopped.reason, StopReason::kThroughSolid);
  EXPECT_LT(ride.robot().translation().x(), 1.7 + 0.02 + 0.05 + 0.01) << "it brakes from 0.5 m/s in 0.05 m";
  map = OccupancyGrid(0.1);
  ride.follower().SetMap(map);
  ride.UntilDone();
}

TEST(PathFollower, HeartbeatDoesNotStartThePathAnew) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(2, 0)});
  double done = 0.0;
  ride.Until([&](const Motion& motion) {
    EXPECT_GE(motion.distance_done, done);
    done = motion.distance_done;
    return motion.state == MotionState::kDone;
  });
  for (int i = 0; i < 50; ++i) EXPECT_EQ(ride.Tick().state, MotionState::kDone);
}

TEST(PathFollower, IsDoneOnlyWhenTheRobotIsWithinTolerance) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(1, 0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 0.9; });
  ride.stuck = true;
  const Motion motion = ride.Until([&](const Motion& m) { return m.state == MotionState::kStopped; });
  EXPECT_EQ(motion.reason, StopReason::kBlocked);
  EXPECT_EQ(motion.distance_left, 0.0);
  ride.robot() = At(0.971, 0);
  EXPECT_EQ(ride.Tick().state, MotionState::kDone);
}

TEST(PathFollower, NewPathOnTheWayIsContinuousInPositionAndVelocity) {
  std::mt19937 random(5);
  for (int round = 0; round < 30; ++round) {
    Ride ride(At(0, 0));
    const PathFollower::Options& limits = ride.follower().options();
    Differences differences;
    ride.Follow(RandomPath(random, At(0, 0), 6, 1.0));
    for (int change = 0; change < 5; ++change) {
      const double start = ride.now();
      ride.Until([&](const Motion& motion) {
        differences.Add(motion.command->T_WB);
        return ride.now() - start > 0.9;
      });
      ride.Follow(RandomPath(random, ride.robot(), 6, 1.0));
    }
    const Motion motion = ride.Until([&](const Motion& m) {
      differences.Add(m.command->T_WB);
      return m.state == MotionState::kDone;
    });
    EXPECT_LE(differences.speed, limits.max_speed + 1e-9);
    EXPECT_LE(differences.turn_rate, limits.max_turn_rate + 1e-9);
    EXPECT_LE(differences.speed_step, limits.max_acceleration * kTick + limits.corner_step + 1e-9);
    EXPECT_LE(differences.turn_step, limits.max_turn_acceleration * kTick + 1e-6);
    EXPECT_EQ(motion.reason, StopReason::kNone);
  }
}

TEST(PathFollower, NewPathStraightOnDoesNotSlowDown) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(2, 0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.Follow({At(0.95, 0), At(4, 0)});
  const double start = ride.now();
  ride.Until([&](const Motion& motion) {
    EXPECT_NEAR(motion.speed, 0.5, 1e-6);
    return ride.now() - start > 2.0;
  });
}

TEST(PathFollower, EmptyPathStops) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(2, 0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.Follow({});
  const double start = ride.now();
  const Motion motion = ride.Until([&](const Motion& m) { return m.speed == 0.0; });
  EXPECT_LE(ride.now() - start, 0.5 / 2.5 + 2.0 * kTick);
  EXPECT_EQ(motion.state, MotionState::kStopped);
  EXPECT_EQ(motion.reason, StopReason::kEmptyPath);
}

TEST(PathFollower, RobotFarFromThePathStandsWhereItIs) {
  Ride ride(At(0, 1));
  ride.Follow({At(0, 0), At(2, 0)});
  const Motion motion = ride.Until([&](const Motion& m) { return m.state != MotionState::kIdle; });
  EXPECT_EQ(motion.state, MotionState::kStopped);
  EXPECT_EQ(motion.reason, StopReason::kOffPath);
  EXPECT_TRUE(motion.command->T_WB.isApprox(At(0, 1)));
}

TEST(PathFollower, RobotPushedAsideStandsThereAndGoesOnWhenItIsBack) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(2, 0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.robot() = At(1, 0.5);
  const Motion motion = ride.Tick();
  EXPECT_EQ(motion.reason, StopReason::kOffPath);
  EXPECT_TRUE(motion.command->T_WB.isApprox(At(1, 0.5)));
  ride.robot() = At(1, 0.1);
  ride.UntilDone();
}

TEST(PathFollower, CommandWaitsForARobotThatIsStuck) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 1.0; });
  ride.stuck = true;
  const double stuck_at = ride.robot().translation().x();
  const PathFollower::Options& limits = ride.follower().options();
  const double farthest =
      limits.max_speed * (limits.max_speed / (2.0 * limits.max_acceleration) + limits.delay);
  const double start = ride.now();
  const Motion motion = ride.Until([&](const Motion& m) {
    EXPECT_LE(m.command->T_WB.translation().x() - stuck_at, farthest + limits.max_speed * kTick);
    return ride.now() - start > 5.0;
  });
  EXPECT_EQ(motion.state, MotionState::kStopped);
  EXPECT_EQ(motion.reason, StopReason::kBlocked);
  EXPECT_LT(motion.speed, 0.02);
  ride.stuck = false;
  ride.UntilDone();
}

TEST(PathFollower, AnotherControllerGoesOnInTheMiddleOfThePath) {
  Ride ride(At(1.5, 0));
  ride.Follow({At(0, 0), At(1, 0), At(1, 0), At(3, 0)});
  const Motion motion = ride.UntilDone();
  EXPECT_NEAR(motion.distance_done, 1.5, 1e-9);
}

TEST(PathFollower, WithoutPathIsIdleAndCommandsNothing) {
  Ride ride(At(0, 0));
  const Motion motion = ride.Tick();
  EXPECT_EQ(motion.state, MotionState::kIdle);
  EXPECT_FALSE(motion.command);
}

TEST(PathFollower, ClockThatStartsAnewDoesNotStopItForEver) {
  PathFollower follower({});
  Time now = Time{} + FromSeconds(1000.0);
  follower.SetPath(now, {At(0, 0), At(1, 0)}, now);
  follower.SetPose(At(0, 0), now);
  follower.Step(now);
  RigidTransform robot = At(0, 0);
  Motion motion;
  for (double t = 0.0; t < 6.0; t += kTick) {
    now = Time{} + FromSeconds(t);
    follower.SetPath(Time{} + FromSeconds(1000.0), {At(0, 0), At(1, 0)}, now);
    follower.SetPose(robot, now);
    motion = follower.Step(now);
    robot = motion.command->T_WB;
    EXPECT_TRUE(robot.matrix().allFinite());
  }
  EXPECT_EQ(motion.state, MotionState::kDone);
}

TEST(PathFollower, RefusesOptionsThatMakeNoSense) {
  EXPECT_THROW(PathFollower({.max_speed = 0.0, .retreat = {}}), std::invalid_argument);
  EXPECT_THROW(PathFollower({.max_turn_rate = std::nan(""), .retreat = {}}), std::invalid_argument);
  EXPECT_THROW(PathFollower({.silence = -1.0, .retreat = {}}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::controller
