#include "services/controller/core/stop_and_turn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "common/geometry/polyline.h"
#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::Differences;
using test::Ride;

Ride Stopping(const PathFollower::Options& options = {}) {
  return Ride(At(0, 0), options, ControllerType::kStopAndTurn);
}

const std::vector<RigidTransform> kCorner = {At(0, 0), At(2, 0, 0, 0.5), At(2, 1, 0.5, 1.0, -0.3)};

/// Expects that the command does not move in the ticks in which it turns.
class MovesOrTurns {
 public:
  void Add(const std::optional<MotionCommand>& command) {
    if (!command) return;
    if (before_) {
      const double moved = (command->T_WB.translation() - before_->translation()).norm();
      const double turned = AngleBetween(command->T_WB, *before_);
      EXPECT_TRUE(moved < 1e-9 || turned < 1e-7) << moved << " m and " << turned << " rad in one tick";
    }
    before_ = command->T_WB;
  }

 private:
  std::optional<RigidTransform> before_;
};

TEST(StopAndTurn, ItNeverTurnsWhileItMovesAndReachesEveryPose) {
  Ride ride = Stopping();
  ride.Follow(kCorner);
  RigidTransform before = ride.robot();
  MovesOrTurns moves_or_turns;
  Differences differences;
  std::size_t passed = 0;
  double flown = 0.0;
  ride.Until([&](const Motion& motion) {
    const RigidTransform& now = ride.robot();
    moves_or_turns.Add(motion.command);
    differences.Add(now);
    flown += (now.translation() - before.translation()).norm();
    before = now;
    if (passed < kCorner.size() && (now.translation() - kCorner[passed].translation()).norm() < 1e-6)
      ++passed;
    return motion.state == MotionState::kDone;
  });
  EXPECT_EQ(passed, kCorner.size());
  EXPECT_NEAR(flown, PathLength(kCorner), 1e-6);
  EXPECT_LT((ride.robot().matrix() - kCorner.back().matrix()).norm(), 1e-3);
  const PathFollower::Options limits;
  EXPECT_LE(differences.speed, limits.robot.max_speed + 1e-9);
  EXPECT_LE(differences.turn_rate, limits.robot.max_turn_rate + 1e-6);
  EXPECT_LE(differences.speed_step, limits.robot.max_acceleration * test::kTick + 1e-6);
}

TEST(StopAndTurn, ReportsTheWholePathOfTheExplorer) {
  Ride ride = Stopping();
  ride.Follow(kCorner);
  const double length = PathLength(kCorner);
  Time id{};
  const Motion last = ride.Until([&](const Motion& motion) {
    if (motion.state == MotionState::kStopped) return false;  // not yet joined
    if (id == Time{}) id = motion.path_id;
    EXPECT_EQ(motion.path_id, id);
    EXPECT_NEAR(motion.distance_done + motion.distance_left, length, 1e-6);
    return motion.state == MotionState::kDone;
  });
  EXPECT_NEAR(last.distance_left, 0.0, 1e-6);
  const Motion after = ride.Tick();
  EXPECT_EQ(after.state, MotionState::kDone);
  EXPECT_EQ(after.path_id, id);
}

TEST(StopAndTurn, BrakesForANewPathBeforeItTurnsAway) {
  for (const double before_corner : {1.0, 1.97}) {
    Ride ride = Stopping();
    ride.Follow(kCorner);
    MovesOrTurns moves_or_turns;
    Differences differences;
    ride.Until([&](const Motion& motion) {
      moves_or_turns.Add(motion.command);
      return ride.robot().translation().x() > before_corner;
    });
    const double x = ride.robot().translation().x();
    ride.Follow({At(x, 0, 0, 0.5), At(x, -1, 0, -1.0)});
    const Time id = ride.time();
    ride.Until([&](const Motion& motion) {
      moves_or_turns.Add(motion.command);
      differences.Add(motion.command->T_WB);
      EXPECT_EQ(motion.state == MotionState::kDone, motion.distance_left == 0.0);
      EXPECT_TRUE(motion.state == MotionState::kFollowing || motion.state == MotionState::kDone);
      EXPECT_LE(motion.path_id, id + FromSeconds(1.0));
      return motion.state == MotionState::kDone;
    });
    EXPECT_NEAR(ride.robot().translation().y(), -1.0, 1e-6);
    EXPECT_NEAR(YawOf(ride.robot().linear()), -1.0, 1e-3);
    const PathFollower::Options limits;
    EXPECT_LE(differences.speed_step,
              limits.emergency_factor * limits.robot.max_acceleration * test::kTick + 1e-6);
  }
}

TEST(StopAndTurn, TurnsOnTheSpotAlsoWhereTheOdometryIsALittleOff) {
  StopAndTurn controller(PathFollower::Options{});
  const RigidTransform offset = At(0.02, -0.01, 0.0);
  RigidTransform robot = At(0, 0);
  Time now = Time{} + FromSeconds(100.0);
  MovesOrTurns moves_or_turns;
  const auto follow = [&](const std::vector<RigidTransform>& path) {
    const Time id = now;
    for (int tick = 0; tick < 3000; ++tick) {
      now += FromSeconds(test::kTick);
      controller.SetPath(id, path, now);
      controller.SetPose(offset * robot, now);
      const Motion motion = controller.Step(now);
      moves_or_turns.Add(motion.command);
      if (motion.command) robot = motion.command->T_WB;
      if (motion.state == MotionState::kDone) return;
    }
    ADD_FAILURE() << "not reached";
  };
  follow({At(0, 0), At(1, 0, 0, 1.0)});
  follow({At(1, 0, 0, 1.0), At(1, 1, 0, -1.0)});
  follow({At(1, 1, 0, 0.0)});
}

TEST(StopAndTurn, PathsWhoseNamesAreConsecutiveAreToldApart) {
  StopAndTurn controller(PathFollower::Options{});
  RigidTransform robot = At(0, 0);
  Time now = Time{} + FromSeconds(100.0);
  const Time id = now;
  const auto ride = [&](Time its_id, const std::vector<RigidTransform>& path, int ticks) {
    Motion motion;
    for (int tick = 0; tick < ticks; ++tick) {
      now += FromSeconds(test::kTick);
      controller.SetPath(its_id, path, now);
      controller.SetPose(robot, now);
      motion = controller.Step(now);
      if (motion.command) robot = motion.command->T_WB;
    }
    return motion;
  };
  ride(id, {At(0, 0), At(2, 0)}, 50);
  const Motion last = ride(id + Duration(1), {At(0, 0), At(0, 0.2)}, 500);
  EXPECT_EQ(last.path_id, id + Duration(1));
  EXPECT_LT(robot.translation().x(), 0.7) << "goes on along the path that was withdrawn";
}

TEST(StopAndTurn, SaysThatAPoseIsMissingAndThatAfterAResetOfTheClockNobodyRepeatsThePath) {
  StopAndTurn controller(PathFollower::Options{});
  const auto at = [](double seconds) { return Time{} + FromSeconds(seconds); };
  controller.SetPath(at(1000.0), {At(0, 0), At(0.1, 0), At(0.2, 0, 0, 1.0), At(3, 0)}, at(1000.0));
  const Motion lacking = controller.Step(at(1000.0));
  EXPECT_EQ(lacking.state, MotionState::kStopped);
  EXPECT_EQ(lacking.reason, StopReason::kNoPose);
  EXPECT_EQ(lacking.path_id, at(1000.0));
  RigidTransform robot = At(0, 0);
  Motion motion;
  for (int tick = 0; tick < 500; ++tick) {
    const Time now = at(test::kTick * tick);
    controller.SetPose(robot, now);
    motion = controller.Step(now);
    if (motion.command) robot = motion.command->T_WB;
  }
  EXPECT_EQ(motion.reason, StopReason::kPathSilent);
  EXPECT_LT(robot.translation().x(), 0.3);
}

TEST(StopAndTurn, FindsItsPathAgainWhereItWasPushedOrLost) {
  Ride ride = Stopping();
  ride.Follow({At(0, 0), At(4, 0), At(4, 1, 0, 1.0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.robot().translation().x() += 2.0;  // along the path
  ride.UntilDone();
  EXPECT_NEAR(ride.robot().translation().y(), 1.0, 0.03);

  Ride lost = Stopping();
  lost.Follow({At(0, 0), At(4, 0), At(4, 1, 0, 1.0)});
  lost.Until([&](const Motion&) { return lost.robot().translation().x() > 1.0; });
  const double began = lost.now();
  lost.Until([&](const Motion&) {
    lost.controller().SetLost(true, lost.time());
    return lost.now() - began > 3.0;
  });
  EXPECT_LT(lost.robot().translation().x(), 1.0) << "it went back";
  MovesOrTurns moves_or_turns;
  lost.Until([&](const Motion& motion) {
    moves_or_turns.Add(motion.command);
    return motion.state == MotionState::kDone;
  });
  EXPECT_NEAR(lost.robot().translation().y(), 1.0, 0.03);
}

TEST(StopAndTurn, AnEmptyPathStopsItAndOneThatIsTooFarAwayIsNotJoined) {
  Ride ride = Stopping();
  ride.Follow(kCorner);
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  ride.Follow({});
  const auto stands = [](const Motion& motion) {
    return motion.state == MotionState::kStopped && motion.speed == 0.0;
  };
  EXPECT_EQ(ride.Until(stands).reason, StopReason::kEmptyPath);
  EXPECT_LT(ride.robot().translation().x(), 1.5);
  ride.Follow({At(1, 5), At(2, 5)});
  EXPECT_EQ(ride.Until([&](const Motion& motion) { return motion.reason == StopReason::kOffPath; }).state,
            MotionState::kStopped);
}

TEST(StopAndTurn, StandsWhenThePathOrThePoseFallsSilentAndBetweenLegs) {
  for (const bool of_pose : {false, true}) {
    Ride ride = Stopping();
    // Legs of 0.1 m: the path falls silent in the middle of some, and at the ends of others.
    std::vector<RigidTransform> path;
    for (int n = 0; n < 50; ++n) path.push_back(At(0.1 * n, 0, 0, 0.01 * (n % 2)));
    ride.Follow(path);
    ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
    (of_pose ? ride.pose_silent : ride.path_silent) = true;
    const double silent_since = of_pose ? ride.now() : ride.last_heard();
    const Motion stopped = ride.Until([&](const Motion&) { return ride.now() - silent_since >= 0.5; });
    EXPECT_EQ(stopped.state, MotionState::kStopped);
    EXPECT_EQ(stopped.reason, of_pose ? StopReason::kPoseSilent : StopReason::kPathSilent);
    EXPECT_EQ(stopped.speed, 0.0);
    const double x = ride.robot().translation().x();
    ride.Until([&](const Motion&) { return ride.now() - silent_since >= 2.0; });
    EXPECT_EQ(ride.robot().translation().x(), x) << "nor does the next leg begin";
    ride.pose_silent = ride.path_silent = false;
    ride.UntilDone();
    EXPECT_NEAR(ride.robot().translation().x(), 4.9, 0.03);
  }
}

TEST(StopAndTurn, StopsBeforeAWall) {
  PathFollower::Options options;
  options.checked_body = PathCheck::Body{.radius = 0.1};
  OccupancyGrid map(0.1);
  for (int x = -10; x < 30; ++x) {
    for (int z = -10; z < 10; ++z) map.Set({x, 5, z}, 2.0F);
  }
  Ride ride = Stopping(options);
  ride.controller().SetMap(map, ride.time());
  ride.Follow({At(0, 0), At(2, 0, 0, 0.5), At(2, 1, 0, 1.0)});
  const Motion stopped = ride.Until([](const Motion& motion) {
    return motion.state == MotionState::kStopped && motion.reason != StopReason::kNoMap;
  });
  EXPECT_EQ(stopped.reason, StopReason::kThroughSolid);
  EXPECT_NEAR(ride.robot().translation().x(), 2.0, 1e-6) << "the first leg is free";
  EXPECT_NEAR(ride.robot().translation().y(), 0.0, 1e-6);
}

TEST(StopAndTurn, CutOffItGoesBackOverAllLegsAndThenFollowsThePathAgain) {
  for (const double y_when_cut_off : {-0.1, 0.3}) {
    PathFollower::Options options;
    options.cut_off = {.action = OnCutOff::kHome, .after = 4.0};
    Ride ride = Stopping(options);
    ride.Follow(kCorner);
    ride.Until([&](const Motion&) {
      return ride.robot().translation().x() > 1.5 && ride.robot().translation().y() > y_when_cut_off;
    });
    ride.path_silent = true;
    ride.Until([](const Motion& motion) { return motion.reason == StopReason::kWentBack; });
    EXPECT_LT(ride.robot().translation().norm(), 0.05);
    ride.path_silent = false;
    ride.UntilDone();
    EXPECT_LT((ride.robot().translation() - kCorner.back().translation()).norm(), 0.03);
  }
}

TEST(StopAndTurn, ARobotThatDrivesFacesAlongEachLegAndEndsInTheLastOrientation) {
  PathFollower::Options options;
  options.robot.drives = true;
  options.robot.drive = Drive::kDifferential;
  Ride ride = Stopping(options);
  ride.Follow({At(0, 0), At(2, 0), At(2, 1), At(1, 1, 0, 1.0)});
  Eigen::Vector3d before_W = ride.robot().translation();
  ride.Until([&](const Motion& motion) {
    const Eigen::Vector3d step_W = ride.robot().translation() - before_W;
    before_W = ride.robot().translation();
    if (step_W.norm() > 1e-3) {
      const double astray = YawOf(ride.robot().linear()) - std::atan2(step_W.y(), step_W.x());
      EXPECT_NEAR(std::remainder(astray, 2.0 * M_PI), 0.0, 0.05);
    }
    return motion.state == MotionState::kDone;
  });
  EXPECT_NEAR(YawOf(ride.robot().linear()), 1.0, 0.05);
  EXPECT_NEAR(ride.robot().translation().x(), 1.0, 0.03);
}

TEST(StopAndTurn, ItsPreviewEndsWithTheLeg) {
  Ride ride = Stopping();
  ride.Follow(kCorner);
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.0; });
  const std::vector<TrajectoryPoint> points = ride.controller().Preview(0.1, 30.0);
  ASSERT_GT(points.size(), 2U);
  EXPECT_NEAR(points.back().T_WB.translation().x(), 2.0, 1e-6);
  EXPECT_EQ(points.back().v_W.norm(), 0.0);
}

TEST(StopAndTurn, RefusesWhatThePathFollowerRefuses) {
  PathFollower::Options options;
  options.silence = 0.0;
  EXPECT_THROW(MakeController(ControllerType::kStopAndTurn, options), std::invalid_argument);
  options = {};
  options.robot = {.drives = true, .drive = Drive::kAckermann, .min_turning_radius = 0.5};
  EXPECT_THROW(MakeController(ControllerType::kStopAndTurn, options), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::controller
