#include "services/controller/core/track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/services/controller/support/poses.h"

namespace thalweg::controller {
namespace {

using test::At;

TEST(Track, PositionIsAtTheArcLengthAlongThePolyline) {
  const Track track({At(0, 0), At(2, 0), At(2, 1)}, {});
  EXPECT_DOUBLE_EQ(track.length(), 3.0);
  EXPECT_TRUE(track.PositionAt(0.5).isApprox(Eigen::Vector3d(0.5, 0, 0)));
  EXPECT_TRUE(track.PositionAt(2.25).isApprox(Eigen::Vector3d(2, 0.25, 0)));
  EXPECT_TRUE(track.PositionAt(9.0).isApprox(Eigen::Vector3d(2, 1, 0)));
  EXPECT_TRUE(track.DirectionAt(2.5).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(Track, SinglePointHasNoLengthAndNoDirection) {
  const Track track({At(1, 2), At(1, 2)}, {});
  EXPECT_EQ(track.length(), 0.0);
  EXPECT_TRUE(track.DirectionAt(0.0).isZero());
  EXPECT_TRUE(track.PositionAt(0.0).isApprox(Eigen::Vector3d(1, 2, 0)));
}

TEST(Track, SpeedBeforeTheEndIsTheBrakingParabola) {
  const Track track({At(0, 0), At(4, 0)}, {.max_speed = 0.5, .max_acceleration = 1.0});
  for (const double left : {0.0, 0.01, 0.05, 0.12}) {
    EXPECT_NEAR(track.SpeedLimitAt(4.0 - left), std::sqrt(2.0 * left), 1e-9) << left;
  }
  EXPECT_DOUBLE_EQ(track.SpeedLimitAt(1.0), 0.5);
}

TEST(Track, RightAngleIsTakenAtTheSpeedThatChangesVelocityByTheCornerStep) {
  const TrackLimits limits{.max_speed = 0.5, .max_acceleration = 1.0, .corner_step = 0.05};
  const Track track({At(0, 0), At(2, 0), At(2, 2)}, limits);
  const double corner = 0.05 / (2.0 * std::sin(std::numbers::pi / 4.0));
  EXPECT_NEAR(track.SpeedLimitAt(2.0 - 1e-12), corner, 1e-6);
}

TEST(Track, FineArcIsTraveledWithinTheLateralAcceleration) {
  const TrackLimits limits{.max_speed = 2.0, .max_acceleration = 1.0, .corner_step = 0.05};
  const double radius = 0.5;
  std::vector<RigidTransform> arc;
  for (int i = 0; i <= 2000; ++i) {
    const double angle = std::numbers::pi * i / 1000.0;
    arc.push_back(At(radius * std::cos(angle), radius * std::sin(angle)));
  }
  const Track track(arc, limits);
  EXPECT_NEAR(track.SpeedLimitAt(0.5), std::sqrt(limits.max_acceleration * radius),
              2e-3);  // v^2 / r = a; braking within a segment
}

/// A straight line, and on from its end a curve whose curvature is that of curvature(share of its length).
template <class Curvature>
std::vector<RigidTransform> StraightAndCurve(double straight, double curve, const Curvature& curvature) {
  constexpr double kApart = 0.002;  // [m] Each corner is a step of the velocity.
  std::vector<RigidTransform> path{At(0, 0), At(straight, 0)};
  double heading = 0.0;
  for (double s = 0.0; s < curve; s += kApart) {
    heading += curvature(s / curve) * kApart;
    const Eigen::Vector3d& p = path.back().translation();
    path.push_back(At(p.x() + kApart * std::cos(heading), p.y() + kApart * std::sin(heading)));
  }
  return path;
}

/// The velocities [m/s] of a robot that follows a track from rest, every 10 ms.
std::vector<Eigen::Vector3d> VelocitiesAlong(const Track& track) {
  constexpr double kTick = 0.01;  // [s]
  std::vector<Eigen::Vector3d> velocities{Eigen::Vector3d::Zero()};
  double s = 0.0;
  double speed = 0.0;
  while (s < track.length() - 1e-3 && velocities.size() < 10'000) {
    const double next = track.NextSpeed(s, speed, kTick);
    s += 0.5 * (speed + next) * kTick;
    speed = next;
    velocities.emplace_back(speed * track.DirectionAt(s));
  }
  return velocities;
}

TEST(Track, WhatCurvesTakeIsNotLeftForGainingAndLosingSpeed) {
  const TrackLimits limits{.max_speed = 2.0, .max_acceleration = 3.0, .corner_step = 0.1};
  const auto round = [](double) { return 0.8; };
  const auto wave = [](double share) { return 1.5 * std::sin(20.0 * share); };
  const auto tightening = [](double share) { return 4.0 * share; };
  const auto opening = [](double share) { return 4.0 * (1.0 - share); };
  for (const auto& path : {StraightAndCurve(2.0, 4.0, round), StraightAndCurve(0.1, 8.0, wave),
                           StraightAndCurve(3.0, 2.0, tightening), StraightAndCurve(0.1, 3.0, opening)}) {
    const Track track(path, limits);
    const std::vector<Eigen::Vector3d> v_W = VelocitiesAlong(track);
    ASSERT_LT(v_W.size(), 1000U) << "arrives";
    double most = 0.0;
    constexpr std::size_t kTicks = 10;
    for (std::size_t n = 0; n + kTicks < v_W.size(); ++n)
      most = std::max(most, (v_W[n + kTicks] - v_W[n]).norm() / (0.01 * kTicks));
    EXPECT_LE(most, 1.04 * limits.max_acceleration);
    EXPECT_GE(most, 0.95 * limits.max_acceleration) << "and uses what there is";
  }
}

TEST(Track, ARobotThatFacesWhereItMovesStopsAtSharpCornersAndPassesCurvesNoFasterThanItTurns) {
  const TrackLimits limits{
      .max_speed = 2.0, .max_acceleration = 10.0, .corner_step = 1.0, .facing_turn_rate = 1.0};
  constexpr double kBend = 0.15;  // [rad]
  std::vector<RigidTransform> path{At(0, 0), At(2, 0)};
  path.push_back(At(2 + 0.4 * std::cos(kBend), 0.4 * std::sin(kBend)));  // gentle, between 2 and 0.4 m
  path.push_back(At(path.back().translation().x(), 3));                  // sharp
  const Track track(path, limits);
  EXPECT_NEAR(track.SpeedLimitAt(2.0 - 1e-12), 0.5 * 1.0 * 0.3 / kBend, 1e-6)
      << "turns at half its rate, over 2 x 0.15 m";
  const double corner = track.NextStop(0.0);
  EXPECT_NEAR(corner, 2.4, 1e-12);
  EXPECT_EQ(track.NextStop(2.3), corner);
  EXPECT_NEAR(track.SpeedLimitAt(corner - 1e-12), 0.0, 1e-5);
  EXPECT_EQ(track.NextStop(corner), track.length());
  EXPECT_EQ(track.NextStop(track.length()), track.length());
  EXPECT_EQ(Track(path, {}).NextStop(0.0), track.length()) << "any other robot stops at the end only";

  std::vector<RigidTransform> arc;
  constexpr double kRadius = 0.5;  // [m]
  for (int i = 0; i <= 300; ++i)
    arc.push_back(At(kRadius * std::cos(0.01 * i), kRadius * std::sin(0.01 * i)));
  const double vertex = 40 * 2.0 * kRadius * std::sin(0.005);  // [m]
  EXPECT_NEAR(Track(arc, limits).SpeedLimitAt(vertex - 1e-12), 0.5 * limits.facing_turn_rate * kRadius, 1e-3);
}

TEST(Track, WhatARobotFacesIsContinuousButWhereItStops) {
  const TrackLimits limits{.facing_turn_rate = 1.0};
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<RigidTransform> path{At(0, 0)};
  double heading = 0.0;
  for (int n = 0; n < 20; ++n) {
    heading += n == 10 ? 1.5 : 0.19 * unit(random);
    const double length = 0.3 + 0.2 * unit(random);
    const Eigen::Vector3d& p = path.back().translation();
    path.push_back(At(p.x() + length * std::cos(heading), p.y() + length * std::sin(heading)));
  }
  const Track track(path, limits);
  const double stop = track.NextStop(0.0);
  ASSERT_LT(stop, track.length());
  constexpr double kApart = 1e-4;  // [m]
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  for (double s = 0.0; s + kApart < track.length(); s += kApart) {
    EXPECT_LE(angle(track.FacingAt(s), track.DirectionAt(s)), 0.5 * kSharpestInCurves) << s;
    if (s < stop && s + kApart >= stop) continue;
    EXPECT_LE(angle(track.FacingAt(s), track.FacingAt(s + kApart)), 2e-3) << s;
  }
  EXPECT_LT(angle(track.FacingAt(stop - 1e-9), track.DirectionAt(stop - 1e-9)), 1e-6);
  EXPECT_LT(angle(track.FacingAt(stop), track.DirectionAt(stop)), 1e-6);
}

TEST(JoinPath, OnThePathGoesOnFromThere) {
  const auto joined = JoinPath({1, 0, 0}, {At(0, 0), At(2, 0), At(2, 2)}, 0.3);
  ASSERT_TRUE(joined);
  const Track track(*joined, {});
  EXPECT_NEAR(track.length(), 3.0, 1e-12);
}

TEST(JoinPath, FarFromThePathIsRefused) {
  EXPECT_FALSE(JoinPath({1, 0.31, 0}, {At(0, 0), At(2, 0)}, 0.3));
}

TEST(JoinPath, PathThatComesBackIsJoinedOnItsFirstPass) {
  const auto joined = JoinPath({1, 0, 0}, {At(0, 0), At(3, 0), At(0, 0)}, 0.3);
  ASSERT_TRUE(joined);
  EXPECT_NEAR(Track(*joined, {}).length(), 5.0, 1e-12);
}

TEST(JoinPath, TheJoinedPathStaysAsNearToThePathAsTheRobotIs) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(-0.3, 0.3);
  for (int round = 0; round < 200; ++round) {
    std::vector<RigidTransform> path{At(0, 0)};
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d p = path.back().translation();
      path.push_back(At(p.x() + 0.4 + step(random), p.y() + step(random), p.z() + step(random)));
    }
    const Track whole(path, {});
    const Eigen::Vector3d robot = whole.PositionAt(1.0 + step(random)) +
                                  0.3 * Eigen::Vector3d(step(random), step(random), step(random));
    const double offset = whole.NearestTo(robot, 0.0, whole.length()).distance;
    const auto joined = JoinPath(robot, path, 0.3);
    ASSERT_TRUE(joined);
    const Track track(*joined, {});
    EXPECT_TRUE(track.PositionAt(0.0).isApprox(robot));
    EXPECT_TRUE(track.end().isApprox(path.back().translation()));
    for (double s = 0.0; s <= track.length(); s += 0.01) {
      EXPECT_LE(whole.NearestTo(track.PositionAt(s), 0.0, whole.length()).distance, 1.1 * offset + 1e-9);
    }
  }
}

TEST(Track, TheNearestPointIsOnThePartThatIsAskedFor) {
  const Track track({At(0, 0), At(1, 0), At(1, 1)}, {});
  const auto nearest = [&](double x, double y, double from, double to) {
    return track.NearestTo({x, y, 0}, from, to);
  };
  EXPECT_NEAR(nearest(0.4, 0.3, 0, 2).s, 0.4, 1e-12);
  EXPECT_NEAR(nearest(0.4, 0.3, 0, 2).distance, 0.3, 1e-12);
  EXPECT_NEAR(nearest(0.9, 0.3, 0, 2).s, 1.3, 1e-12);
  EXPECT_NEAR(nearest(0.9, 0.3, 0, 0.7).s, 0.7, 1e-12);
  EXPECT_NEAR(nearest(0.9, 0.3, 0, 0.7).distance, std::hypot(0.2, 0.3), 1e-12);
  EXPECT_NEAR(nearest(0.5, 0, -3, -1).distance, 0.5, 1e-12);
  EXPECT_NEAR(nearest(1, 1.5, 1.9, 7).s, 2.0, 1e-12);
}

// From d before a right angle to e behind it, the straight line passes the corner at d e / sqrt(d^2 + e^2).
TEST(Track, ReachEndsWhereTheStraightLineCutsACorner) {
  const Track track({At(0, 0), At(1, 0), At(1, 1)}, {});
  constexpr double kMost = 0.02;
  for (const double d : {0.03, 0.1, 0.3}) {
    const double e = d * kMost / std::sqrt(d * d - kMost * kMost);
    const double reach = track.ReachWithoutCutting({1 - d, 0, 0}, 1 - d, 1 - d, 2.0, kMost);
    EXPECT_LE(reach, 1 + e) << d;
    EXPECT_GT(reach, 1 + e - 0.011) << d;
  }
  const Eigen::Vector3d before(0.9, 0, 0);
  EXPECT_EQ(track.ReachWithoutCutting({0.99, 0, 0}, 0.99, 0.99, 2.0, kMost), 2.0)
      << "so near it cuts nothing";
  EXPECT_EQ(track.ReachWithoutCutting(before, 0.9, 1.3, 2.0, kMost), 1.3) << "it cuts already";
  EXPECT_EQ(track.ReachWithoutCutting(before, 0.9, 0.9, 0.95, kMost), 0.95);
  EXPECT_EQ(track.ReachWithoutCutting({1, 0.9, 0}, 1.9, 1.9, 2.5, kMost), 2.5) << "the end is no corner";
}

}  // namespace
}  // namespace thalweg::controller
