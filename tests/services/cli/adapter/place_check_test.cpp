#include "services/cli/adapter/place_check.h"

#include <gmock/gmock.h>

#include "tests/support/meshes.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

/// A room whose floor is at z = 0.
simulator::World Room() {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-3, -3, 0), Eigen::Vector3d(3, 3, 2.5));
  return simulator::World(test::BoxMesh(box.min(), box.max()), box);
}

RobotModel Driving() {
  RobotModel robot;
  robot.drives = true;
  robot.height = 0.4;
  return robot;
}

TEST(PlaceCheck, ARobotThatDrivesStartsOnTheFloor) {
  EXPECT_EQ(FloatingText(Driving(), Room(), {0, 0, 0.2}), "");
  EXPECT_EQ(FloatingText(Driving(), Room(), {0, 0, 0.2 + 0.24}), "") << "on its wheels";
  EXPECT_THAT(FloatingText(Driving(), Room(), {0, 0, 0.2 + 0.5}), HasSubstr("0.50 m above the floor"));
  EXPECT_THAT(FloatingText(Driving(), Room(), {10, 0, 1.0}), HasSubstr("above no floor"));
}

TEST(PlaceCheck, ARobotThatFliesMayStartAnywhere) {
  RobotModel robot = Driving();
  robot.drives = false;
  EXPECT_EQ(FloatingText(robot, Room(), {0, 0, 2.0}), "");
}

TEST(PlaceCheck, ShippedPlacesHaveNothingWrongWithThem) {
  EXPECT_TRUE(CheckPlace(LoadScenario("tiny", {})).empty());
}

}  // namespace
}  // namespace thalweg::cli
