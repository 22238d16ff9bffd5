#include "services/evaluator/core/motion_meter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace thalweg::evaluator {
namespace {

constexpr double kStep = 0.02;  // [s]

/// A body that is at x(t), turned about the vertical by yaw(t), for that many seconds.
MotionFigures FiguresOf(double seconds, const std::function<double(double)>& x,
                        const std::function<double(double)>& yaw) {
  const auto at = [&](double t) {
    return MakeTransform(RotationFromYawPitch(yaw(t), 0.0), Eigen::Vector3d(x(t), 0.0, 1.0));
  };
  MotionMeter meter(at(0.0));
  const int steps = static_cast<int>(std::lround(seconds / kStep));
  for (int k = 1; k <= steps; ++k) meter.Move(at(kStep * k), kStep);
  return meter.figures();
}

TEST(MotionMeter, SplitsTimeIntoMovingTurningAndStanding) {
  // Moves for 1 s, stands for 1 s, turns for 2 s, moves and turns for 1 s, and stands for 0.5 s.
  const auto x = [](double t) { return 0.5 * (std::min(t, 1.0) + std::clamp(t - 4.0, 0.0, 1.0)); };
  const auto yaw = [](double t) { return std::clamp(t - 2.0, 0.0, 3.0); };
  const MotionFigures figures = FiguresOf(5.5, x, yaw);
  EXPECT_NEAR(figures.moving, 2.0, 1e-9);
  EXPECT_NEAR(figures.turning, 2.0, 1e-9);
  EXPECT_NEAR(figures.standing, 1.5, 1e-9);
  EXPECT_EQ(figures.stops, 2U);
  EXPECT_NEAR(figures.most_speed, 0.5, 1e-9);
  EXPECT_NEAR(figures.most_turn_rate, 1.0, 1e-6);
  EXPECT_NEAR(figures.sharpest_curve, 2.0, 1e-5);
}

TEST(MotionMeter, FindsTheAccelerationsOfRamps) {
  const auto ramp = [](double t) { return 0.5 * t * t; };
  const MotionFigures figures = FiguresOf(
      1.0, [&](double t) { return 1.5 * ramp(t); }, [&](double t) { return 0.8 * ramp(t); });
  EXPECT_NEAR(figures.most_acceleration, 1.5, 1e-6);
  EXPECT_NEAR(figures.most_turn_acceleration, 0.8, 1e-4);
  EXPECT_NEAR(figures.most_speed, 1.5, 0.02);
  EXPECT_NEAR(figures.most_turn_rate, 0.8, 0.02);
}

TEST(MotionMeter, FindsTheJerkOfARampOfTheAcceleration) {
  const auto x = [](double t) { return 4.0 * t * t * t / 6.0; };
  EXPECT_NEAR(FiguresOf(1.0, x, [](double) { return 0.0; }).most_jerk, 4.0, 1e-6);
}

TEST(MotionMeter, FindsTheSpeedAcrossWhereTheBodyFaces) {
  // Moves along x at 0.5 m/s, whatever it faces.
  const auto x = [](double t) { return 0.5 * t; };
  EXPECT_NEAR(FiguresOf(1.0, x, [](double) { return 0.0; }).most_sideways_speed, 0.0, 1e-9);
  EXPECT_NEAR(FiguresOf(1.0, x, [](double) { return -0.3; }).most_sideways_speed, 0.5 * std::sin(0.3), 1e-9);
}

TEST(MotionMeter, FindsTheCentripetalAccelerationOfACircle) {
  constexpr double kRadius = 2.0;
  constexpr double kRate = 0.9;  // [rad/s]
  const auto at = [&](double t) {
    const Eigen::Vector3d p_W(kRadius * std::cos(kRate * t), kRadius * std::sin(kRate * t), 0.0);
    return MakeTransform(Eigen::Matrix3d::Identity(), p_W);
  };
  MotionMeter meter(at(0.0));
  for (int k = 1; k <= 200; ++k) meter.Move(at(kStep * k), kStep);
  EXPECT_NEAR(meter.figures().most_acceleration, kRadius * kRate * kRate, 0.01);
  EXPECT_EQ(meter.figures().stops, 0U);
  EXPECT_EQ(meter.figures().most_turn_rate, 0.0);
}

}  // namespace
}  // namespace thalweg::evaluator
