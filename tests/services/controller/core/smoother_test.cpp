#include "services/controller/core/smoother.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

namespace thalweg::controller {
namespace {

constexpr double kWindow = 0.3;  // [s]
constexpr double kFine = 0.01;   // [s]

/// Moves the smoother's point along a curve, from rest before time 0, and calls visit(time) after each tick.
void Along(Smoother& smoother, const std::function<Eigen::Vector3d(double)>& at, double duration,
           const std::function<void(double)>& visit) {
  smoother.Restart(at(0.0));
  for (int n = 1; n * kFine <= duration + 1e-9; ++n) {
    smoother.Move(at(n * kFine), kFine);
    visit(n * kFine);
  }
}

TEST(Smoother, StandsWhereItStarts) {
  Smoother smoother(kWindow);
  smoother.Restart({1.0, 2.0, 3.0});
  EXPECT_TRUE(smoother.stands());
  EXPECT_EQ(smoother.position(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(smoother.velocity(), Eigen::Vector3d::Zero());
}

TEST(Smoother, IsHalfAWindowLateAtASteadySpeed) {
  Smoother smoother(kWindow);
  Along(
      smoother, [](double t) { return Eigen::Vector3d(0.7 * t, 0.0, 0.0); }, 2.0,
      [&](double t) {
        EXPECT_FALSE(smoother.stands());
        if (t < kWindow) return;
        EXPECT_NEAR(smoother.position().x(), 0.7 * (t - 0.5 * kWindow), 1e-12);
        EXPECT_NEAR(smoother.velocity().x(), 0.7, 1e-12);
      });
}

TEST(Smoother, ArrivesOneWindowAfterItsPoint) {
  Smoother smoother(kWindow);
  Along(
      smoother, [](double t) { return Eigen::Vector3d(std::min(t, 0.5), 0.0, 0.0); }, 0.5 + kWindow - kFine,
      [](double) {});
  EXPECT_FALSE(smoother.stands());
  for (int n = 0; n < 3; ++n) smoother.Move({0.5, 0.0, 0.0}, kFine);
  EXPECT_TRUE(smoother.stands());
  EXPECT_EQ(smoother.position(), Eigen::Vector3d(0.5, 0.0, 0.0));
  EXPECT_EQ(smoother.velocity(), Eigen::Vector3d::Zero());
}

TEST(Smoother, CutsACircleAsItsHeaderSays) {
  constexpr double kRadius = 0.8;
  constexpr double kSpeed = 1.2;
  const double acceleration = kSpeed * kSpeed / kRadius;
  Smoother smoother(kWindow);
  Along(
      smoother,
      [](double t) {
        const double angle = kSpeed * t / kRadius;
        return Eigen::Vector3d(kRadius * std::cos(angle), kRadius * std::sin(angle), 0.0);
      },
      3.0,
      [&](double t) {
        if (t < kWindow) return;
        const double cut = kRadius - smoother.position().norm();
        EXPECT_NEAR(cut, acceleration * kWindow * kWindow / 24.0, 0.02 * cut);
      });
}

TEST(Smoother, LimitsTheChangeOfTheAcceleration) {
  // Full acceleration, full braking and a standstill in random turns.
  constexpr double kMost = 2.0;  // [m/s^2]
  std::mt19937 random(5);
  std::uniform_int_distribution<int> lasts(1, 40);
  Smoother smoother(kWindow);
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  smoother.Restart(p);
  std::vector<double> velocities;
  double speed = 0.0;
  for (int turn = 0; turn < 200; ++turn) {
    const double a = kMost * (turn % 3 - 1);
    for (int n = lasts(random); n > 0; --n) {
      const double next = std::clamp(speed + a * kFine, 0.0, 1.5);
      p.x() += 0.5 * (speed + next) * kFine;
      speed = next;
      smoother.Move(p, kFine);
      velocities.push_back(smoother.velocity().x());
    }
  }
  for (std::size_t n = 2; n < velocities.size(); ++n) {
    EXPECT_GE(velocities[n], 0.0);
    EXPECT_LE(velocities[n], 1.5 + 1e-12);
    EXPECT_LE(std::abs(velocities[n] - velocities[n - 1]), kMost * kFine + 1e-12);
    const double jerk = (velocities[n] - 2.0 * velocities[n - 1] + velocities[n - 2]) / (kFine * kFine);
    EXPECT_LE(std::abs(jerk), 2.0 * kMost / kWindow + 1e-8);
  }
}

TEST(Smoother, IsTheMeanForTicksOfAnyLength) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> length(0.001, 0.2);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  Smoother smoother(kWindow);
  std::vector<std::pair<double, Eigen::Vector3d>> knots{{-1.0, {0.3, -0.2, 0.1}}, {0.0, {0.3, -0.2, 0.1}}};
  smoother.Restart(knots[0].second);
  const auto at = [&](double time) {
    std::size_t n = 1;
    while (knots[n].first < time) ++n;
    const double share = (time - knots[n - 1].first) / (knots[n].first - knots[n - 1].first);
    return Eigen::Vector3d(knots[n - 1].second + share * (knots[n].second - knots[n - 1].second));
  };
  for (int turn = 0; turn < 100; ++turn) {
    const double dt = length(random);
    knots.push_back({knots.back().first + dt, {coordinate(random), coordinate(random), coordinate(random)}});
    smoother.Move(knots.back().second, dt);
    constexpr int kSamples = 20000;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < kSamples; ++k) sum += at(knots.back().first - kWindow * (k + 0.5) / kSamples);
    EXPECT_LT((smoother.position() - sum / kSamples).norm(), 1e-5);
    const Eigen::Vector3d velocity = (knots.back().second - at(knots.back().first - kWindow)) / kWindow;
    EXPECT_LT((smoother.velocity() - velocity).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace thalweg::controller
