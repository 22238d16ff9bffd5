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
  ride.controller().SetMap(map, ride.time());
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
  ride.controller().SetMap(map, ride.time());
  ride.Follow({At(0, 0), At(5, 0)});
  ride.Until([&](const Motion&) { return ride.robot().translation().x() > 1.7; });
  map = WallAhead();
  ride.controller().SetMap(map, ride.time());
  const Motion stopped = ride.Until(
      [&](const Motion& motion) { return motion.state == MotionState::kStopped && motion.speed == 0.0; });
  EXPECT_EQ(stopped.reason, StopReason::kThroughSolid);
  EXPECT_LT(ride.robot().translation().x(), 1.7 + 0.02 + 0.05 + 0.01) << "it brakes from 0.5 m/s in 0.05 m";
  map = OccupancyGrid(0.1);
  ride.controller().SetMap(map, ride.time());
  ride.UntilDone();
}

PathFollower::Options GoingOn() {
  PathFollower::Options options;
  options.checked_body = PathCheck::Body{.radius = 0.1};
  options.cut_off.action = OnCutOff::kGoOn;
  return options;
}

/// Cut off from its explorer 1 m along a path of 4 m. Its map is updated up to `map_until` [m], and shows a
/// wall from 1.2 m on if there is one.
Motion RideCutOff(Ride& ride, OccupancyGrid& map, double map_until, bool wall) {
  ride.controller().SetMap(map, ride.time());
  ride.Follow({At(0, 0), At(4, 0)});
  ride.Until([&](const Motion&) {
    ride.controller().SetMap(map, ride.time());
    return ride.robot().translation().x() > 1.0;
  });
  ride.path_silent = true;
  const double cut = ride.now();
  return ride.Until([&](const Motion& motion) {
    const double x = ride.robot().translation().x();
    if (wall && x > 1.2) map = WallAhead();
    if (x < map_until) ride.controller().SetMap(map, ride.time());
    if (ride.now() - cut > 0.6 && motion.speed > 0.0 && x < map_until) {
      EXPECT_EQ(motion.reason, StopReason::kGoingOn);
      EXPECT_EQ(motion.state, MotionState::kFollowing);
    }
    return motion.state == MotionState::kDone ||
           (motion.state == MotionState::kStopped && motion.speed == 0.0);
  });
}

TEST(PathFollower, CutOffItGoesOnToTheEndOfItsPathWhileItsMapIsKeptUpToDate) {
  OccupancyGrid map(0.1);
  Ride ride(At(0, 0), GoingOn());
  EXPECT_EQ(RideCutOff(ride, map, 10.0, false).state, MotionState::kDone);
  EXPECT_NEAR(ride.robot().translation().x(), 4.0, 0.03);
  const double there = ride.now();
  EXPECT_EQ(ride.Until([&](const Motion&) { return ride.now() - there > 10.0; }).state, MotionState::kDone);
}

TEST(PathFollower, CutOffItStopsBeforeAWallThatItsMapShows) {
  OccupancyGrid map(0.1);
  Ride ride(At(0, 0), GoingOn());
  EXPECT_EQ(RideCutOff(ride, map, 10.0, true).reason, StopReason::kThroughSolid);
  EXPECT_LT(ride.robot().translation().x(), 1.9);
}

TEST(PathFollower, CutOffItStopsWhenItsMapIsCutOffAsWell) {
  OccupancyGrid map(0.1);
  Ride ride(At(0, 0), GoingOn());
  EXPECT_EQ(RideCutOff(ride, map, 2.0, false).reason, StopReason::kPathSilent);
  EXPECT_LT(ride.robot().translation().x(), 2.0 + 1.0 * 0.5 + 0.1) << "1 s later, at 0.5 m/s";
  ride.path_silent = false;
  ride.controller().SetMap(map, ride.time());
  ride.UntilDone();
}

TEST(PathFollower, WithoutAMapItCannotGoOn) {
  PathFollower::Options options;
  options.cut_off.action = OnCutOff::kGoOn;
  EXPECT_THROW(PathFollower{options}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::controller
