#include "services/simulator/adapter/moving_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "common/scenario/models.h"
#include "services/simulator/adapter/load_mesh.h"
#include "tests/support/places.h"

namespace thalweg::simulator {
namespace {

using Point = Eigen::Vector3d;

TEST(MovingParts, AreThoseOfTheScenarioInMetersAndRadians) {
  Scenario scenario;
  EXPECT_TRUE(MovingPartsFrom(scenario).empty());
  thalweg::MovingPart& given = *scenario.mutable_world()->add_moving();
  given.mutable_max_m()->set_x(2.0);
  given.mutable_max_m()->set_y(1.0);
  given.mutable_max_m()->set_z(4.0);
  given.set_period_s(30.0);
  given.add_places()->set_yaw_deg(-90.0);
  thalweg::MovingPart::Place& second = *given.add_places();
  second.set_time_s(7.0);
  second.mutable_offset_m()->set_y(3.0);

  const std::vector<MovingPart> parts = MovingPartsFrom(scenario);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].at_rest_W.max(), Point(2, 1, 4));
  EXPECT_EQ(parts[0].pivot_W, Point(1, 0.5, 2)) << "by default its center";
  EXPECT_EQ(parts[0].period, 30.0);
  ASSERT_EQ(parts[0].places.size(), 2U);
  EXPECT_NEAR(parts[0].places[0].yaw, -std::numbers::pi / 2.0, 1e-12);
  EXPECT_EQ(parts[0].places[0].time, 0.0);
  EXPECT_EQ(parts[0].places[1].time, 7.0);
  EXPECT_EQ(parts[0].places[1].offset_W, Point(0, 3, 0));
  given.mutable_pivot_m()->set_x(2.0);
  EXPECT_EQ(MovingPartsFrom(scenario)[0].pivot_W, Point(2, 0, 0));
}

TEST(MovingParts, TheShippedFlatStartsWithItsDoorOpenAndNoRandomStartInItsWay) {
  const Scenario scenario = LoadScenario(test::SourceFolder() + "/deploy/scenarios/flat_doors.txtpb");
  const World world = LoadWorld(scenario);
  ASSERT_EQ(world.parts().size(), 2U);
  EXPECT_THAT(DescriptionOf(scenario, world), testing::HasSubstr("2 parts move; explored within"));
  EXPECT_TRUE(world.InSight({2.9, 3.6, 1.2}, {2.9, 4.6, 1.2})) << "through the doorway";
  const RobotModel robot = RobotFrom(scenario);
  for (const Point& place : StartPlacesFrom(scenario, world, robot)) {
    for (const PartInMotion& part : world.parts()) {
      for (double time = 0.0; time < 120.0; time += 0.5) {
        ASSERT_GT(DistanceTo(part.part(), PoseAt(part.part(), time), robot, place), 0.05);
      }
    }
  }
}

}  // namespace
}  // namespace thalweg::simulator
