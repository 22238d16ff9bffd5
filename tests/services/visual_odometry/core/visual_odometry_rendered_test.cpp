#include <gtest/gtest.h>

#include "common/base/angles.h"
#include "services/simulator/adapter/load_mesh.h"
#include "tests/services/visual_odometry/support/follow_flight.h"

namespace thalweg::visual_odometry {
namespace {

TEST(RenderedSequence, APieceOfARoundIsFollowed) {
  const simulator::World world = simulator::LoadWorld(LoadScenario("kitchen"));
  const test::Outcome outcome = test::Follow(world, test::FlyRounds(world, test::Motion::kSmooth, 0.6));
  test::Print(outcome);
  EXPECT_LT(outcome.error.drift_max, 0.005 * outcome.error.path_length + 0.001);
  EXPECT_EQ(outcome.not_tracking, 0);
  EXPECT_GT(outcome.inside_position, 0.75) << "few frames, so wider bounds than for whole rounds";
}

/// Turns in place, facing a wall, by 4 degrees per frame.
test::Flight TurnAt(const Eigen::Vector3d& p_W) {
  test::Flight flight;
  for (int yaw_deg = 90; yaw_deg >= -90; yaw_deg -= 4) {
    const double yaw = yaw_deg * kDegree;
    flight.T_WCs.push_back(MakeTransform(RotationFromYawPitch(yaw, 0.0) * BodyFromOptical(), p_W));
  }
  return flight;
}

TEST(RenderedSequence, ATurnBesideAWallIsFollowedThoughAllThatIsSeenIsNear) {
  const simulator::World world = simulator::LoadWorld(LoadScenario("tiny"));
  const test::Flight flight = TurnAt({2.83, 1.9, 0.9});  // 0.2 m from the wall
  ASSERT_NEAR(world.DistanceToSurface(flight.T_WCs.front().translation(), 1.0), 0.2, 0.01);
  const test::Outcome outcome = test::Follow(world, flight);
  test::Print(outcome);
  EXPECT_EQ(outcome.not_tracking, 0);
  EXPECT_LT(outcome.error.drift_max, 0.01);
  EXPECT_LT(outcome.error.drift_angle, 0.01);
}

}  // namespace
}  // namespace thalweg::visual_odometry
