#include "services/controller/core/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/attitude.h"

namespace thalweg::controller {
namespace {

constexpr double kTurnTick = 0.02;  // [s]
const Orientation::Limits kWithGimbal{.rate = 1.6, .acceleration = 4.0, .gimbal_rate = 0.8};

Eigen::Quaterniond Looking(double yaw, double pitch) {
  return Eigen::Quaterniond(RotationFromYawPitch(yaw, pitch));
}

TEST(Orientation, OfAGimbalTakesTheTimeOfTheLongerTrapezoid) {
  for (const auto& [yaw, pitch] : {std::pair(2.5, -0.1), {0.3, -1.5}, {0.0, 0.5}, {-2.0, 0.0}}) {
    Orientation orientation(kWithGimbal);
    double time = 0.0;
    while (orientation.q_WB().angularDistance(Looking(yaw, pitch)) > 1e-6 ||
           orientation.rate_B().norm() > 1e-6) {
      orientation.TurnTo(Looking(yaw, pitch), 10.0, kTurnTick);
      time += kTurnTick;
      ASSERT_LT(time, 20.0);
    }
    const auto trapezoid = [](double angle, double rate) {
      const double a = kWithGimbal.acceleration;
      return angle * a < rate * rate ? 2.0 * std::sqrt(angle / a) : angle / rate + rate / a;
    };
    EXPECT_NEAR(time, std::max(trapezoid(std::abs(yaw), 1.6), trapezoid(std::abs(pitch), 0.8)),
                4.0 * kTurnTick);
  }
}

TEST(Orientation, OfAGimbalNeverRollsAndKeepsItsRatesAndAccelerations) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Orientation orientation(kWithGimbal);
  YawPitch before{};
  double yaw_rate = 0.0;
  double pitch_rate = 0.0;
  for (int turn = 0; turn < 60; ++turn) {
    const Eigen::Quaterniond wanted = Looking(3.0 * unit(random), 1.5 * unit(random));
    for (int n = 0; n < 40; ++n) {
      if (turn % 5 == 4) {
        orientation.Brake(1.0, kTurnTick);
      } else {
        orientation.TurnTo(wanted, 10.0, kTurnTick);
      }
      const Eigen::Matrix3d R_WB = orientation.q_WB().toRotationMatrix();
      EXPECT_NEAR(R_WB(2, 1), 0.0, 1e-9);
      const YawPitch now = YawPitchOf(R_WB);
      const double new_yaw_rate = WrappedAngle(now.yaw - before.yaw) / kTurnTick;
      const double new_pitch_rate = (now.pitch - before.pitch) / kTurnTick;
      EXPECT_LE(std::abs(new_yaw_rate), kWithGimbal.rate + 1e-5);
      EXPECT_LE(std::abs(new_pitch_rate), kWithGimbal.gimbal_rate + 1e-5);
      EXPECT_LE(std::abs(new_yaw_rate - yaw_rate), kWithGimbal.acceleration * kTurnTick + 1e-5);
      EXPECT_LE(std::abs(new_pitch_rate - pitch_rate), kWithGimbal.acceleration * kTurnTick + 1e-5);
      // The rate is what turned it.
      const Eigen::Vector3d w_W = R_WB * orientation.rate_B();
      EXPECT_NEAR(w_W.z(), new_yaw_rate, 1e-5);
      EXPECT_NEAR(-orientation.rate_B().y(), new_pitch_rate, 1e-5);
      before = now;
      yaw_rate = new_yaw_rate;
      pitch_rate = new_pitch_rate;
    }
  }
}

TEST(Orientation, TurnsNoFasterThanItIsAllowed) {
  for (const Orientation::Limits& limits : {Orientation::Limits{}, kWithGimbal}) {
    Orientation orientation(limits);
    for (int n = 0; n < 100; ++n) {
      orientation.TurnTo(Looking(3.0, 1.0), 0.3, kTurnTick);
      EXPECT_LE(orientation.rate_B().norm(), std::sqrt(2.0) * 0.3 + 1e-9);
    }
  }
}

TEST(Orientation, OfAGimbalStandsStraightDownAndStraightUp) {
  for (const double pitch : {-0.5 * std::numbers::pi, 0.5 * std::numbers::pi}) {
    Orientation orientation(kWithGimbal);
    for (int n = 0; n < 400; ++n) orientation.TurnTo(Looking(2.0, pitch), 10.0, kTurnTick);
    EXPECT_EQ(orientation.rate_B(), Eigen::Vector3d::Zero());
    EXPECT_LT(orientation.q_WB().angularDistance(Looking(2.0, pitch)), 1e-7);
  }
}

TEST(Orientation, BrakesToAStand) {
  for (const Orientation::Limits& limits : {Orientation::Limits{}, kWithGimbal}) {
    Orientation orientation(limits);
    for (int n = 0; n < 50; ++n) orientation.TurnTo(Looking(3.0, 1.0), 10.0, kTurnTick);
    ASSERT_GT(orientation.rate_B().norm(), 1.0);
    double time = 0.0;
    for (; orientation.rate_B().norm() > 1e-9 && time < 5.0; time += kTurnTick)
      orientation.Brake(2.5, kTurnTick);
    EXPECT_NEAR(time, 1.6 / (2.5 * 4.0), 2.0 * kTurnTick);
  }
}

}  // namespace
}  // namespace thalweg::controller
