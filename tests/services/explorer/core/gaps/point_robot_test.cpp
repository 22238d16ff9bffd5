#include "services/explorer/core/gaps/point_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/services/explorer/support/gap_rooms.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;
using Kind = GapEvent::Kind;

TEST(PointRobot, AGapDisappearsAndAppearsWhereItsWallIsInLine) {
  const Polygon corridor = test::BentCorridor();
  PointRobot robot(corridor, {1.0, 1.0}, {});
  EXPECT_THAT(robot.gaps(), ElementsAre(4));
  EXPECT_THAT(robot.MoveTowards({4.0, 1.0}), Optional(GapEvent{Kind::kDisappear, 0}));
  EXPECT_THAT(robot.gaps(), IsEmpty());
  EXPECT_NEAR(robot.position().x(), 3.01, 1e-12);  // half the clearance after the wall's extension, x = 3
  EXPECT_EQ(robot.MoveTowards({4.0, 1.0}), std::nullopt);
  EXPECT_EQ(robot.position(), Vector2d(4.0, 1.0));
  EXPECT_THAT(robot.MoveTowards({1.0, 1.0}), Optional(GapEvent{Kind::kAppear, 0}));
  EXPECT_THAT(robot.gaps(), ElementsAre(4));
  EXPECT_NEAR(robot.position().x(), 2.99, 1e-12);
}

TEST(PointRobot, GapsThatHideTheSameSideMergeAndSplitAtTheirBitangent) {
  const Polygon corridor = test::TwoDeadEnds();
  PointRobot robot(corridor, {1.0, 1.0}, {});
  EXPECT_THAT(robot.gaps(), ElementsAre(6, 10));
  // At x = 1 the line through (4, 1.9) and (8, 2.4) is 1.525 high.
  EXPECT_THAT(robot.MoveTowards({1.0, 1.8}), Optional(GapEvent{Kind::kMerge, 0}));
  EXPECT_THAT(robot.gaps(), ElementsAre(10));
  EXPECT_NEAR(robot.position().y(), 1.535, 1e-12);
  EXPECT_THAT(robot.MoveTowards({1.0, 1.0}), Optional(GapEvent{Kind::kSplit, 0}));
  EXPECT_THAT(robot.gaps(), ElementsAre(6, 10));
  EXPECT_NEAR(robot.position().y(), 1.515, 1e-12);
}

TEST(PointRobot, GapsThatHideOppositeSidesMergeAndSplitAtTheirBitangent) {
  const Polygon corridor = test::TwoTeeth();
  PointRobot robot(corridor, {1.0, 1.0}, {});
  EXPECT_THAT(robot.gaps(), ElementsAre(2, 7));
  // At x = 1 the line through (4, 1.2) and (7, 1) is 1.4 high.
  EXPECT_THAT(robot.MoveTowards({1.0, 1.8}), Optional(GapEvent{Kind::kMerge, 0}));
  EXPECT_THAT(robot.gaps(), ElementsAre(7));
  EXPECT_NEAR(robot.position().y(), 1.41, 1e-12);
  EXPECT_THAT(robot.MoveTowards({1.0, 1.0}), Optional(GapEvent{Kind::kSplit, 0}));
  EXPECT_THAT(robot.gaps(), ElementsAre(2, 7));
}

TEST(PointRobot, ChasesAGapRoundItsCornerUntilTheNextWallIsInSight) {
  const Polygon corridor = test::BentCorridor();
  PointRobot robot(corridor, {1.0, 1.0}, {.clearance = 0.1});
  EXPECT_EQ(robot.Chase(0), (GapEvent{Kind::kDisappear, 0}));
  // Straight to the corner, and then around it to below it.
  EXPECT_GT(robot.position().x(), 3.0);
  EXPECT_NEAR((robot.position() - Vector2d(3.0, 2.0)).norm(), 0.1, 0.02);
  EXPECT_NEAR(robot.length(), std::sqrt(5.0) - 0.1 + 0.1 * std::atan2(2.0, 1.0), 0.06);
}

TEST(PointRobot, RefusesAStartThatIsNotInside) {
  const Polygon corridor = test::BentCorridor();
  EXPECT_THROW(PointRobot(corridor, {1.0, 3.0}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
