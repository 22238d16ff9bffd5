#include <gtest/gtest.h>

#include "services/simulator/adapter/load_mesh.h"
#include "tests/services/visual_odometry/follow_flight.h"

namespace thalweg::visual_odometry {
namespace {

TEST(RenderedSequence, APieceOfARoundIsFollowed) {
  const simulator::World world = simulator::LoadWorld(LoadScenario("kitchen"));
  const test::Outcome outcome = test::Follow(world, test::FlyRounds(world, test::Motion::kSmooth, 0.6));
  test::Tell(outcome);
  EXPECT_LT(outcome.error.drift_max, 0.005 * outcome.error.path_length + 0.001);
  EXPECT_EQ(outcome.not_tracking, 0);
  EXPECT_GT(outcome.inside_position, 0.75) << "few frames, so wider bounds than for whole rounds";
}

}  // namespace
}  // namespace thalweg::visual_odometry
