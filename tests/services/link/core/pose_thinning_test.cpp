#include "services/link/core/pose_thinning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""ms;

struct Stamped {
  Time stamp;
  RigidTransform T;
};

/// The poses whose messages pass; a message is the pose's number.
std::vector<std::size_t> PassingOf(PoseThinning& thinning, const std::vector<Stamped>& poses) {
  std::vector<std::size_t> passing;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Buffer number{static_cast<std::uint8_t>(k >> 8U), static_cast<std::uint8_t>(k)};
    for (const Buffer& message : thinning.Add(poses[k].stamp, poses[k].T, number)) {
      passing.push_back(std::size_t{message[0]} << 8U | message[1]);
    }
  }
  return passing;
}

std::vector<Stamped> At50Hz(int count, const std::function<RigidTransform(double)>& pose) {
  std::vector<Stamped> poses;
  for (int k = 0; k < count; ++k) poses.push_back({Time{20ms * k}, pose(0.02 * k)});
  return poses;
}

TEST(PoseThinning, OfAStraightFlightPassesOnePoseInAPeriod) {
  PoseThinning thinning({.period = 100ms});
  const auto poses = At50Hz(501, [](double t) {
    return MakeTransform(Eigen::Matrix3d::Identity(), {0.5 * t, 0.0, 0.0});
  });
  const auto passing = PassingOf(thinning, poses);
  ASSERT_EQ(passing.size(), 101U);
  for (std::size_t n = 0; n < passing.size(); ++n) EXPECT_EQ(passing[n], 5 * n);
}

TEST(PoseThinning, WhatIsLeftOutCanBeInterpolatedWithinTheLimits) {
  const PoseThinning::Options options{.period = 200ms};
  PoseThinning thinning(options);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::Vector3d p(0, 0, 0);
  double yaw = 0.0;
  double speed = 0.0;
  double turn = 0.0;
  int until_change = 0;
  const auto poses = At50Hz(3000, [&](double) {
    if (until_change-- == 0) {  // stops, goes and turns at once
      speed = 0.5 * uniform(random);
      turn = 1.5 * uniform(random);
      until_change = 3 + static_cast<int>(random() % 40);
    }
    yaw += 0.02 * turn;
    p += 0.02 * speed * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.1);
    return MakeTransform(RotationFromYawPitch(yaw, 0.0), p);
  });
  const auto passing = PassingOf(thinning, poses);
  EXPECT_LT(passing.size(), poses.size() / 2);
  for (std::size_t n = 1; n < passing.size(); ++n) {
    const Stamped& a = poses[passing[n - 1]];
    const Stamped& b = poses[passing[n]];
    ASSERT_GT(b.stamp, a.stamp);
    EXPECT_LE(b.stamp - a.stamp, options.period + 20ms);
    for (std::size_t k = passing[n - 1]; k <= passing[n]; ++k) {
      const RigidTransform T =
          Interpolate(a.T, b.T, Seconds(poses[k].stamp - a.stamp) / Seconds(b.stamp - a.stamp));
      EXPECT_LE((T.translation() - poses[k].T.translation()).norm(), options.position + 1e-12);
      EXPECT_LE(AngleBetween(T, poses[k].T), options.angle + 1e-7);
    }
  }
}

TEST(PoseThinning, AClockThatWasRestartedBeginsAgain) {
  PoseThinning thinning({.period = 100ms});
  const RigidTransform T = RigidTransform::Identity();
  EXPECT_EQ(thinning.Add(Time{10'000ms}, T, {1}).size(), 1U);
  EXPECT_EQ(thinning.Add(Time{20ms}, T, {2}).size(), 1U);
  EXPECT_EQ(thinning.Add(Time{40ms}, T, {3}).size(), 0U);
}

TEST(RateLimit, PassesOneMessageInAPeriodAndAllThatGoBackInTime) {
  RateLimit limit(50ms);
  int passed = 0;
  for (int k = 0; k < 100; ++k) passed += limit.Passes(Time{10ms * k}) ? 1 : 0;
  EXPECT_EQ(passed, 20);
  EXPECT_TRUE(limit.Passes(Time{0ms}));
}

}  // namespace
}  // namespace thalweg::link
