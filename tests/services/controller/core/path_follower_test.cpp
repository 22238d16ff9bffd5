#include "services/controller/core/path_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::Differences;
using test::kTick;
using test::RandomPath;
using test::Ride;

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

TEST(PathFollower, StaysOnThePolylineWithinAMicrometer) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    Ride ride(At(0, 0));
    const auto path = RandomPath(random, At(0, 0), 12, 0.4);
    const Track track(path, {});
    ride.Follow(path);
    ride.Until([&](const Motion& motion) {
      EXPECT_LT(track.NearestTo(motion.command->T_WB.translation(), 0.0, track.length()).distance, 1e-6);
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
    const PathFollower::Options& limits = ride.options();
    Differences differences;
    ride.Until([&](const Motion& motion) {
      differences.Add(motion.command->T_WB);
      return motion.state == MotionState::kDone;
    });
    EXPECT_LE(differences.speed, limits.robot.max_speed + 1e-9);
    EXPECT_LE(differences.turn_rate, limits.robot.max_turn_rate + 1e-9);
    // Where a corner lies within a tick, its velocity step adds to that of the acceleration.
    EXPECT_LE(differences.speed_step, limits.robot.max_acceleration * kTick + limits.corner_step + 1e-9);
    EXPECT_LE(differences.turn_step, limits.robot.max_turn_acceleration * kTick + 1e-6);
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

TEST(PathFollower, HeartbeatDoesNotStartThePathAgain) {
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
  const PathFollower::Options& limits = ride.options();
  const double farthest = limits.robot.max_speed *
                          (limits.robot.max_speed / (2.0 * limits.robot.max_acceleration) + limits.delay);
  const double start = ride.now();
  const Motion motion = ride.Until([&](const Motion& m) {
    EXPECT_LE(m.command->T_WB.translation().x() - stuck_at, farthest + limits.robot.max_speed * kTick);
    return ride.now() - start > 5.0;
  });
  EXPECT_EQ(motion.state, MotionState::kStopped);
  EXPECT_EQ(motion.reason, StopReason::kBlocked);
  EXPECT_LT(motion.speed, 0.02);
  ride.stuck = false;
  ride.UntilDone();
}

// It moves straight to a command that has gone around the corner meanwhile.
TEST(PathFollower, ARobotThatHearsFewCommandsCutsCornersByTwoCentimetersAtMost) {
  for (const double corner_deg : {45.0, 90.0, 150.0}) {
    const double turn = corner_deg * std::numbers::pi / 180.0;
    for (const int hears_every : {10, 30, 60}) {
      for (double corner = 1.0; corner < 1.3; corner += 0.03) {
        const std::vector<RigidTransform> path{At(0, 0), At(corner, 0),
                                               At(corner + std::cos(turn), std::sin(turn))};
        const Track track(path, {});
        Ride ride(At(0, 0));
        ride.hears_every = hears_every;
        ride.Follow(path);
        double farthest = 0.0;
        ride.Until([&](const Motion& motion) {
          farthest =
              std::max(farthest, track.NearestTo(ride.robot().translation(), 0.0, track.length()).distance);
          return motion.state == MotionState::kDone;
        });
        EXPECT_LT(farthest, 0.021) << "one in " << hears_every << ", corner of " << corner_deg
                                   << " degrees after " << corner << " m";
      }
    }
  }
}

TEST(PathFollower, ARobotThatIsStuckBeforeACornerIsReportedAsBlocked) {
  Ride ride(At(0, 0));
  ride.Follow({At(0, 0), At(1, 0), At(1, 1)});
  ride.Until([&](const Motion& motion) { return motion.distance_done > 0.95; });
  ride.stuck = true;
  const Motion motion = ride.Until([](const Motion& m) { return m.reason == StopReason::kBlocked; }, 5.0);
  EXPECT_NEAR(motion.command->T_WB.translation().x(), 1.0, 1e-9);
  EXPECT_LT(motion.command->T_WB.translation().y(), 0.025);
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

/// Moves only where it faces.
PathFollower::Options Facing() {
  PathFollower::Options options;
  options.robot.drives = true;
  options.robot.drive = Drive::kDifferential;
  return options;
}

TEST(AFacingFollower, TurnsOnTheSpotAtTheStartAtCornersAndAtTheEnd) {
  Ride ride(At(0, 0, 0, -1.0), Facing());
  ride.Follow({At(0, 0), At(2, 0, 0, 3.0), At(2, 1, 0, -2.0)});  // whatever orientations lie on the path
  const double start = ride.now();
  const Motion motion = ride.UntilDone();
  const auto travel = [](double length) { return length / 0.5 + 0.5 / 1.0; };
  const auto turn = [](double angle) { return angle / 1.6 + 1.6 / 4.0; };
  const double pi = std::numbers::pi;
  const double early = std::sqrt(2.0 * 0.02 / 4.0);  // it sets out before it has turned the last 0.02 rad
  EXPECT_NEAR(ride.now() - start,
              turn(1.0) + travel(2.0) + turn(0.5 * pi) + travel(1.0) + turn(1.5 * pi - 2.0) - 2.0 * early,
              6.0 * kTick);
  EXPECT_NEAR(AngleBetween(motion.command->T_WB, At(2, 1, 0, -2.0)), 0.0, 1e-6);
}

TEST(AFacingFollower, NeverMovesAcrossWhereItFaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 30; ++round) {
    std::vector<RigidTransform> path{At(0, 0)};
    double heading = 3.0 * unit(random);
    for (int n = 0; n < 30; ++n) {  // curves, and a sharp corner now and then
      heading += n % 7 == 0 ? 3.0 * unit(random) : 0.19 * unit(random);
      const Eigen::Vector3d p_W =
          path.back().translation() + 0.2 * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
      path.push_back(At(p_W.x(), p_W.y(), 0, 3.0 * unit(random)));
    }
    Ride ride(At(0, 0, 0, 3.0 * unit(random)), Facing());
    ride.Follow(path);
    RigidTransform before = ride.robot();
    ride.Until([&](const Motion& motion) {
      const RigidTransform& now = motion.command->T_WB;
      const Eigen::Vector3d step_B = before.linear().transpose() * (now.translation() - before.translation());
      // Half of a corner that belongs to a curve, and as much by which the turn lags behind.
      EXPECT_LE(std::abs(step_B.y()), std::tan(0.2) * step_B.x() + 1e-9) << round;
      EXPECT_EQ(motion.command->v_WB_B.y(), 0.0);
      before = now;
      return motion.state == MotionState::kDone;
    });
    EXPECT_NEAR((ride.robot().translation() - path.back().translation()).norm(), 0.0, 1e-6);
    EXPECT_NEAR(AngleBetween(ride.robot(), path.back()), 0.0, 1e-5);
  }
}

TEST(AFacingFollower, VelocityCommandsSteerARobotBackToThePathCriticallyDamped) {
  // With feedback f and an offset y0 beside a straight line: y = y0 (1 + f t) exp(-f t), for small angles.
  constexpr double kOffset = 0.005;  // [m]
  PathFollower::Options options = Facing();
  options.feedback = 2.0;
  Ride ride(At(0, 0), options);
  ride.stuck = true;  // moves by the velocity commands below, in place of taking the pose
  ride.Follow({At(0, 0), At(8, 0)});
  double offset_since = -1.0;
  double t = 0.0;
  ride.Until([&](const Motion& motion) {
    if (!motion.command) return false;
    if (offset_since < 0.0 && motion.distance_done > 1.0) {  // at full speed
      ride.robot().translation().y() += kOffset;
      offset_since = ride.now();
      return false;
    }
    ride.robot().translation() += ride.robot().linear() * motion.command->v_WB_B * kTick;
    ride.robot().linear() =
        ride.robot().linear() *
        Eigen::AngleAxisd(motion.command->w_WB_B.z() * kTick, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    if (offset_since < 0.0) return false;
    t += kTick;
    EXPECT_NEAR(ride.robot().translation().y(),
                kOffset * (1.0 + options.feedback * t) * std::exp(-options.feedback * t), 0.06 * kOffset)
        << t;
    return t > 3.0;
  });
}

/// Turns only in curves, the tightest of 0.5 m.
PathFollower::Options InCurves() {
  PathFollower::Options options;
  options.robot.drives = true;
  options.robot.drive = Drive::kAckermann;
  options.robot.min_turning_radius = 0.5;
  return options;
}

/// Arcs of 0.6 m: forward to the left by 90 degrees, back to the right of where it then faces by 60 more, and
/// forward to the left again by 30.
std::vector<RigidTransform> ThreePointTurn() {
  std::vector<RigidTransform> path{At(0, 0)};
  double yaw = 0.0;
  const auto drive = [&](double along, double turn) {
    constexpr int kPieces = 20;
    for (int n = 0; n < kPieces; ++n) {
      const double chord = 2.0 * 0.6 * std::sin(0.5 * turn / kPieces) * along;
      const double mean = yaw + 0.5 * turn / kPieces;
      const Eigen::Vector3d p_W =
          path.back().translation() + chord * Eigen::Vector3d(std::cos(mean), std::sin(mean), 0.0);
      yaw += turn / kPieces;
      path.push_back(At(p_W.x(), p_W.y(), 0, yaw));
    }
  };
  drive(1.0, 0.5 * std::numbers::pi);
  drive(-1.0, std::numbers::pi / 3.0);
  drive(1.0, std::numbers::pi / 6.0);
  return path;
}

TEST(AFollowerInCurves, DrivesForwardAndBackAndTurnsNoTighterThanItCan) {
  Ride ride(At(0, 0), InCurves());
  const std::vector<RigidTransform> path = ThreePointTurn();
  ride.Follow(path);
  RigidTransform before = ride.robot();
  double back = 0.0;
  ride.Until([&](const Motion& motion) {
    const RigidTransform& now = motion.command->T_WB;
    const Eigen::Vector3d step_B = before.linear().transpose() * (now.translation() - before.translation());
    EXPECT_LE(AngleBetween(before, now), step_B.norm() / 0.5 + 1e-9) << "not on the spot either";
    EXPECT_LE(std::abs(step_B.y()), 0.1 * std::abs(step_B.x()) + 1e-9);
    EXPECT_EQ(motion.command->v_WB_B.y(), 0.0);
    EXPECT_LE(std::abs(motion.command->w_WB_B.z()), std::abs(motion.command->v_WB_B.x()) / 0.5 + 1e-9);
    back -= std::min(0.0, step_B.x());
    before = now;
    return motion.state == MotionState::kDone;
  });
  EXPECT_NEAR((ride.robot().translation() - path.back().translation()).norm(), 0.0, 1e-6);
  EXPECT_NEAR(AngleBetween(ride.robot(), At(0, 0, 0, std::numbers::pi)), 0.0, 1e-5);
  EXPECT_NEAR(back, 0.6 * std::numbers::pi / 3.0, 0.01);
}

TEST(AFollowerInCurves, SteersARobotThatObeysOnlyVelocitiesAlongThePath) {
  Ride ride(At(0, 0), InCurves());
  ride.stuck = true;  // moves by the velocity commands below, in place of taking the pose
  const std::vector<RigidTransform> path = ThreePointTurn();
  const Track track(path, {});
  ride.Follow(path);
  ride.robot() = At(0, 0.03, 0, 0.05);
  double farthest = 0.0;
  ride.Until([&](const Motion& motion) {
    if (!motion.command) return false;
    ride.robot().translation() += ride.robot().linear() * motion.command->v_WB_B * kTick;
    ride.robot().linear() =
        ride.robot().linear() *
        Eigen::AngleAxisd(motion.command->w_WB_B.z() * kTick, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    farthest = std::max(farthest, track.NearestTo(ride.robot().translation(), 0.0, track.length()).distance);
    return motion.state == MotionState::kDone;
  });
  EXPECT_LT(farthest, 0.08);
  EXPECT_LT((ride.robot().translation() - path.back().translation()).norm(), 0.08);
}

TEST(AFollowerInCurves, DoesNotJoinAPathAcrossWhichItStands) {
  Ride ride(At(0, 0, 0, 1.0), InCurves());
  ride.Follow({At(0, 0), At(2, 0)});
  const Motion motion = ride.Until([](const Motion& m) { return m.state == MotionState::kStopped; });
  EXPECT_EQ(motion.reason, StopReason::kOffPath);
  EXPECT_NEAR(AngleBetween(ride.robot(), At(0, 0, 0, 1.0)), 0.0, 1e-9);
}

TEST(AFollowerInCurves, JoinsAPathThatItFacesAlongByAndLarge) {
  Ride ride(At(0, 0.02, 0, 0.2), InCurves());
  ride.stuck = true;
  ride.Follow({At(0, 0), At(2, 0)});
  for (int n = 0; n < 10; ++n) EXPECT_EQ(ride.Tick().reason, StopReason::kNone) << n;
  EXPECT_GT(ride.Tick().command->v_WB_B.x(), 0.0);
}

TEST(AFollowerInCurves, GoesBackTheWayItCameWhenItIsCutOff) {
  PathFollower::Options options = InCurves();
  options.cut_off = {.action = OnCutOff::kRetreat, .after = 1.0, .step = 0.3};
  Ride ride(At(0, 0), options);
  ride.Follow(ThreePointTurn());
  ride.Until([](const Motion& motion) { return motion.distance_done > 1.2; });
  ride.path_silent = true;
  RigidTransform before = ride.robot();
  ride.Until([&](const Motion& motion) {
    const double way = (motion.command->T_WB.translation() - before.translation()).norm();
    EXPECT_LE(AngleBetween(before, motion.command->T_WB), way / 0.5 + 0.01);
    before = motion.command->T_WB;
    return motion.back == BackPlace::kFartherBack;
  });
}

TEST(PathFollower, RefusesOptionsThatMakeNoSense) {
  PathFollower::Options without_radius = InCurves();
  without_radius.robot.min_turning_radius = 0.0;
  EXPECT_THROW(PathFollower{without_radius}, std::invalid_argument);
  EXPECT_THROW(PathFollower({.robot = {.max_speed = 0.0}, .retreat = {}}), std::invalid_argument);
  EXPECT_THROW(PathFollower({.robot = {.max_turn_rate = std::nan("")}, .retreat = {}}),
               std::invalid_argument);
  EXPECT_THROW(PathFollower({.silence = -1.0, .retreat = {}}), std::invalid_argument);
}

TEST(PathFollower, OfAGimbalArrivesWhateverOrientationsThePathGives) {
  RobotModel robot{.attitude = Attitude::kGimbal};
  const Eigen::Matrix3d rolled =
      RotationFromYawPitch(0.7, 1.2) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  Ride ride(At(0, 0), {.robot = robot, .retreat = {}});
  ride.Follow({At(0, 0), MakeTransform(rolled, {1.0, 0.0, 0.0})});
  const Motion motion = ride.UntilDone();
  EXPECT_NEAR(motion.command->T_WB.linear()(2, 1), 0.0, 1e-9) << "no roll";
  EXPECT_NEAR(motion.command->T_WB.linear()(2, 0), std::sin(robot.gimbal_highest), 1e-9);
}

TEST(PathFollower, OfAGimbalGoesBackWhenItIsCutOff) {
  RobotModel robot{.attitude = Attitude::kGimbal};
  PathFollower::Options options{.robot = robot, .retreat = {}};
  options.cut_off = {.action = OnCutOff::kRetreat, .after = 1.0, .step = 0.3};
  std::mt19937 random(6);
  Ride ride(At(0, 0), options);
  ride.Follow(RandomPath(random, At(0, 0), 8, 0.5));
  for (int n = 0; n < 400; ++n) ride.Tick();
  ride.path_silent = true;
  ride.Until([](const Motion& motion) { return motion.back == BackPlace::kFartherBack; });
  ride.Until([](const Motion& motion) { return motion.reason == StopReason::kWentBack; });
}

TEST(PathFollower, TheBaseOfAGimbalMovesLevelAndEachAxisKeepsItsRateWhileTheGimbalLagsBehind) {
  RobotModel robot{.attitude = Attitude::kGimbal};
  robot.max_turn_rate = 0.4;
  Ride ride(At(0, 0), {.robot = robot, .retreat = {}});
  ride.Follow({At(0, 0), MakeTransform(RotationFromYawPitch(2.5, -1.4), {3.0, 0.0, 0.0})});
  bool moved = false;
  for (int n = 0; n < 150; ++n) {
    ride.robot().linear() = RotationFromYawPitch(0.0, -0.5);  // it does not turn at all
    const Motion motion = ride.Tick();
    if (!motion.command) continue;
    const MotionCommand level = motion.command->Leveled();
    EXPECT_NEAR(level.v_WB_B.z(), 0.0, 1e-9) << "neither rises nor sinks";
    EXPECT_NEAR(level.w_WB_B.x(), 0.0, 1e-9) << "nor rolls";
    EXPECT_LE(std::abs(level.w_WB_B.z()), robot.max_turn_rate + 1e-9);
    EXPECT_LE(std::abs(level.w_WB_B.y()), robot.max_gimbal_rate + 1e-9);
    moved = moved || level.v_WB_B.x() > 0.3;
  }
  EXPECT_TRUE(moved);
}

TEST(MotionCommand, IsLeveledForABaseThatCarriesAGimbal) {
  // It moves ahead at 0.4 m/s, turns left at 0.3 rad/s and pitches down at 0.2 rad/s, looking steeply down.
  const Eigen::Matrix3d R_WB = RotationFromYawPitch(0.8, -1.3);
  const Eigen::Vector3d ahead_W(std::cos(0.8), std::sin(0.8), 0.0);
  const MotionCommand command{
      .T_WB = MakeTransform(RotationFromYawPitch(1.1, 0.2), {1, 2, 3}),
      .v_WB_B = R_WB.transpose() * (0.4 * ahead_W),
      .w_WB_B = R_WB.transpose() * Eigen::Vector3d(0, 0, 0.3) + Eigen::Vector3d(0, 0.2, 0),
      .T_WB_of_velocities = MakeTransform(R_WB, {1, 2, 3})};
  const MotionCommand level = command.Leveled();
  EXPECT_LT((level.v_WB_B - Eigen::Vector3d(0.4, 0, 0)).norm(), 1e-12);
  EXPECT_LT((level.w_WB_B - Eigen::Vector3d(0, 0.2, 0.3)).norm(), 1e-12);
}

}  // namespace
}  // namespace thalweg::controller
