#include "services/controller/core/retreat.h"

#include <gtest/gtest.h>

namespace thalweg::controller {
namespace {

constexpr double kStep = 0.02;

RigidTransform At(double x, double yaw = 0.0) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, 0.0, 0.0});
}

TEST(Retreat, GoesBackAsTheRobotCameWithinItsSpeed) {
  Retreat::Options options;
  Retreat retreat(options);
  for (int k = 0; k <= 20; ++k) retreat.Note(At(0.02 * k, 0.03 * k));
  RigidTransform T_WB = At(0.4, 0.6);
  for (;;) {
    const auto next = retreat.Back(T_WB, kStep);
    if (!next) break;
    EXPECT_LE((next->translation() - T_WB.translation()).norm(), options.max_speed * kStep + 1e-9);
    EXPECT_LE(AngleBetween(*next, T_WB), options.max_turn_rate * kStep + 1e-9);
    EXPECT_LE(next->translation().x(), T_WB.translation().x() + 1e-9);
    EXPECT_NEAR(AngleBetween(*next, At(0.0, 1.5 * next->translation().x())), 0.0, 1e-6);
    T_WB = *next;
  }
  EXPECT_TRUE(T_WB.isApprox(At(0.0)));
}

TEST(Retreat, IsNoLongerThanItsReach) {
  Retreat retreat({.reach = 0.3});
  for (int k = 0; k <= 100; ++k) retreat.Note(At(0.02 * k));
  Retreat turn({.turn_reach = 0.5});
  for (int k = 0; k <= 100; ++k) turn.Note(At(0.0, 0.03 * k));
  RigidTransform after_travel = At(2.0);
  while (const auto next = retreat.Back(after_travel, kStep)) after_travel = *next;
  EXPECT_NEAR(after_travel.translation().x(), 1.7, 0.021);
  RigidTransform after_turn = At(0.0, 3.0);
  while (const auto next = turn.Back(after_turn, kStep)) after_turn = *next;
  EXPECT_NEAR(AngleBetween(after_turn, At(0.0, 3.0)), 0.5, 0.031);
}

TEST(Retreat, OfARobotThatHasNotMovedIsToStand) {
  Retreat retreat({});
  EXPECT_FALSE(retreat.Back(At(0.0), kStep));
  retreat.Note(At(0.0));
  EXPECT_FALSE(retreat.Back(At(0.0), kStep));
}

}  // namespace
}  // namespace thalweg::controller
