#include "services/controller/core/retreat.h"

#include <gtest/gtest.h>

#include "tests/services/controller/support/poses.h"

namespace thalweg::controller {
namespace {

using test::OnAxis;

constexpr double kStep = 0.02;

TEST(Retreat, GoesBackAsTheRobotCameWithinItsSpeed) {
  Retreat::Options options;
  Retreat retreat(options);
  for (int k = 0; k <= 20; ++k) retreat.Note(OnAxis(0.02 * k, 0.03 * k));
  RigidTransform T_WB = OnAxis(0.4, 0.6);
  for (;;) {
    const auto next = retreat.Back(T_WB, kStep);
    if (!next) break;
    EXPECT_LE((next->translation() - T_WB.translation()).norm(), options.max_speed * kStep + 1e-9);
    EXPECT_LE(AngleBetween(*next, T_WB), options.max_turn_rate * kStep + 1e-9);
    EXPECT_LE(next->translation().x(), T_WB.translation().x() + 1e-9);
    EXPECT_NEAR(AngleBetween(*next, OnAxis(0.0, 1.5 * next->translation().x())), 0.0, 1e-6);
    T_WB = *next;
  }
  EXPECT_TRUE(T_WB.isApprox(OnAxis(0.0)));
}

TEST(Retreat, IsNoLongerThanItsReach) {
  Retreat retreat({.reach = 0.3});
  for (int k = 0; k <= 100; ++k) retreat.Note(OnAxis(0.02 * k));
  Retreat turn({.turn_reach = 0.5});
  for (int k = 0; k <= 100; ++k) turn.Note(OnAxis(0.0, 0.03 * k));
  RigidTransform after_travel = OnAxis(2.0);
  while (const auto next = retreat.Back(after_travel, kStep)) after_travel = *next;
  EXPECT_NEAR(after_travel.translation().x(), 1.7, 0.021);
  RigidTransform after_turn = OnAxis(0.0, 3.0);
  while (const auto next = turn.Back(after_turn, kStep)) after_turn = *next;
  EXPECT_NEAR(AngleBetween(after_turn, OnAxis(0.0, 3.0)), 0.5, 0.031);
}

TEST(Retreat, OfARobotThatHasNotMovedIsToStand) {
  Retreat retreat({});
  EXPECT_FALSE(retreat.Back(OnAxis(0.0), kStep));
  retreat.Note(OnAxis(0.0));
  EXPECT_FALSE(retreat.Back(OnAxis(0.0), kStep));
}

}  // namespace
}  // namespace thalweg::controller
