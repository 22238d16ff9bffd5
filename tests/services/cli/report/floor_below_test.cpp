#include "services/cli/report/floor_below.h"

#include <gmock/gmock.h>

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

/// A floor whose surface is at z = 0, seen within `reach` voxels, and free space above it.
OccupancyGrid Floor(int reach) {
  OccupancyGrid map(0.1);
  for (int x = -reach; x < reach; ++x) {
    for (int y = -reach; y < reach; ++y) {
      map.Set({x, y, -1}, 2.0F);
      for (int z = 0; z < 20; ++z) map.Set({x, y, z}, -2.0F);
    }
  }
  return map;
}

RobotModel Driving() {
  RobotModel robot;
  robot.drives = true;
  robot.height = 0.4;
  return robot;
}

TEST(FloorBelow, IsMeasuredFromTheLowerEndOfTheBody) {
  EXPECT_NEAR(*FloorBelow(Floor(10), 0.4, {0, 0, 0.32}), 0.12, 1e-9);
  EXPECT_NEAR(*FloorBelow(Floor(10), 0.4, {0, 0, 1.19}), 0.99, 1e-9);
}

TEST(FloorBelow, IsTheMedianOfWhatIsKnown) {
  OccupancyGrid map = Floor(10);
  for (int x = 2; x < 8; ++x) {
    for (int y = -5; y < 5; ++y) map.Set({x, y, 5}, 2.0F);  // a table
  }
  EXPECT_NEAR(*FloorBelow(map, 0.4, {0, 0, 1.2}), 1.0, 1e-9);
}

TEST(FloorBelow, IsUnknownWhileLittleOfItIsSeen) {
  EXPECT_EQ(FloorBelow(Floor(3), 0.4, {0, 0, 0.3}), std::nullopt);
  EXPECT_EQ(FloorBelow(Floor(10), 0.4, {0, 0, 5.0}), std::nullopt) << "unknown space in between";
  EXPECT_EQ(FloorBelow(Floor(10), 0.4, {0, 0, 0.1}), std::nullopt) << "the body is in the floor";
}

TEST(FloorBelow, OnlyARobotThatDrivesHighAboveItIsTold) {
  const OccupancyGrid map = Floor(10);
  EXPECT_EQ(FloatingText(Driving(), map, {0, 0, 0.2 + 0.24}), "");
  EXPECT_THAT(FloatingText(Driving(), map, {0, 0, 0.2 + 0.99}), HasSubstr("is 0.99 m below its body"));
  RobotModel flying = Driving();
  flying.drives = false;
  EXPECT_EQ(FloatingText(flying, map, {0, 0, 1.19}), "");
}

}  // namespace
}  // namespace thalweg::cli
