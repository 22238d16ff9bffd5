#include <gtest/gtest.h>

#include "services/controller/core/path_follower.h"
#include "tests/services/controller/support/ride.h"

namespace thalweg::controller {
namespace {

using test::At;
using test::Ride;

/// A wall at x = 2 m.
OccupancyGrid WallAhead() {
  OccupancyGrid map(0.1);
  for (int y = -10; y < 10; ++y) {
    for (int z = -10; z < 10; ++z) map.Set({20, y, z}, 2.0F);
  }
  return map;
}

TEST(PathFollower, APathThroughWhatIsKnownToBeSolidIsRefusedAndTheNextOneFollowed) {
  PathFollower::Options options;
  options.checked_body = PathCheck::Body{.radius = 0.1};
  const OccupancyGrid map = WallAhead();
  Ride ride(At(0, 0), options);
  ride.Follow({At(0, 0), At(5, 0)});
  EXPECT_EQ(ride.Until([](const Motion& motion) { return motion.state == MotionState::kStopped; }).reason,
            StopReason::kNoMap);
  ride.follower().SetMap(map);
  const double start = ride.now();
  const Motion refused = ride.Until([&](const Motion&) { return ride.now() - start > 2.0; });
  EXPECT_EQ(refused.state, MotionState::kStopped);
  EXPECT_EQ(refused.reason, StopReason::kThroughSolid);
  ASSERT_TRUE(refused.obstacle_W);
  EXPECT_NEAR(refused.obstacle_W->x(), 2.05, 1e-9);
  EXPECT_LT(ride.robot().translation().norm(), 1e-9);
  ride.Follow({At(0, 0), At(1.5, 0)});
  ride.UntilDone();
  EXPECT_NEAR(ride.robot().translation().x(), 1.5, 0.03);
}

TEST(PathFollower, StopsBeforeAWallThatBecomesKnownOnTheWayAndGoesOnWhenItIsGone) {
  PathFollower::Options options;
  options.checked_body = PathCheck::Body{.radius = 0.1};
  OccupancyGrid map(0.1);
  Ride ride(At(0, 0), options);
  ride.follower().SetMap(map);
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.7; });
  map = WallAhead();
  ride.follower().SetMap(map);
  const Motion stopped = ride.Until(
      [&](const Motion& motion) { return motion.state == MotionState::kStopped && motion.speed == 0.0; });
  EXPECT_EQ(stopped.reason, StopReason::kThroughSolid);
  EXPECT_LT(ride.robot().translation().x(), 1.7 + 0.02 + 0.05 + 0.01) << "it brakes from 0.5 m/s in 0.05 m";
  map = OccupancyGrid(0.1);
  ride.follower().SetMap(map);
  ride.UntilDone();
}

}  // namespace
}  // namespace thalweg::controller
