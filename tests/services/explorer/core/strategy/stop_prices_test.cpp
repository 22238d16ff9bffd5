#include "services/explorer/core/strategy/stop_prices.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "services/explorer/core/path/motion_times.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Matrix3d Heading(double yaw) {
  return RotationFromYawPitch(yaw, 0.0);
}

/// Free space with the robot in its middle, which looks along x.
class StopPricesTest : public testing::Test {
 protected:
  StopPricesTest() {
    map_.Apply(test::BoxOf({{-40, -40, -10}, {41, 41, 11}}, VoxelState::kFree));
    search_.Flood(map_, {{{0, 0, 0}, 0}});
    robot_.max_speed = 2.0;
    robot_.max_acceleration = 4.0;
    robot_.max_turn_rate = 0.5 * kPi;
    robot_.max_turn_acceleration = kPi;
  }
  Situation situation() const {
    return {map_, search_,      map_.CenterOf({0, 0, 0}), test::kClearance,
            {},   test::kViews, test::kSensorRange,       test::kLookRange};
  }
  Situation Timed() const {
    Situation its = situation();
    its.time = {robot_, Heading(0.0)};
    return its;
  }
  /// A cube beside a place, so near that a body there would touch a surface a voxel nearer than it.
  void Narrow(const VoxelIndex& place) {
    const VoxelIndex beside = place + VoxelIndex{0, 0, 2};
    map_.Apply(test::BoxOf({beside, beside + VoxelIndex{1, 1, 1}}, VoxelState::kOccupied));
  }

  PlanningMap map_{{.voxel_size = test::kSize, .clearance = test::kClearance, .bounds = {}}};
  PathSearch search_;
  RobotModel robot_;
};

TEST_F(StopPricesTest, WhereOnlyThePathCountsItIsThePrice) {
  const std::vector<CoverStop> stops = {{.place = {20, 0, 0}}, {.place = {0, 30, 0}}};
  const Situation its = situation();
  const StopPrices prices(its, stops);
  EXPECT_NEAR(prices.FromRobot(0), 2.0, 1e-9);
  EXPECT_EQ(prices.Between(0, 1, 4.5), 4.5);
}

TEST_F(StopPricesTest, WhereTimeCountsATurnThatFitsIntoTheTravelCostsNothing) {
  const std::vector<CoverStop> stops = {{.place = {30, 0, 0}, .R_WB = Heading(0.0)},
                                        {.place = {30, 0, 0}, .R_WB = Heading(0.25 * kPi)},
                                        {.place = {2, 0, 0}, .R_WB = Heading(kPi)},
                                        {.place = {0, 0, 0}, .R_WB = Heading(0.5 * kPi), .is_here = true}};
  const Situation its = Timed();
  const StopPrices prices(its, stops);
  // 3 m take 2 s, in which the robot would travel 2 m at its usual speed; half a turn takes 2.5 s.
  EXPECT_NEAR(prices.FromRobot(0), 2.0, 1e-9);
  EXPECT_NEAR(prices.FromRobot(1), 2.0, 1e-9);
  EXPECT_NEAR(prices.FromRobot(2), 2.5, 1e-9);
  EXPECT_NEAR(prices.FromRobot(3), 1.5, 1e-9);
  EXPECT_NEAR(prices.Between(0, 1, 0.0), 1.0, 1e-9);
  EXPECT_EQ(prices.Between(0, 2, 2.8), prices.Between(2, 0, 2.8));
}

TEST_F(StopPricesTest, AZoneCostsWhatIsFlownInItBesidesTheWay) {
  const std::vector<CoverStop> stops = {
      {.place = {0, 20, 0}, .items = {0}, .R_WB = Heading(0.0)},
      {.place = {0, 20, 0}, .items = {1}, .R_WB = Heading(0.0), .is_zone = true},
      {.place = {0, 20, 0}, .items = {2, 3, 4}, .R_WB = Heading(0.0), .is_zone = true}};
  const Situation its = Timed();
  const StopPrices prices(its, stops);
  EXPECT_EQ(prices.FromRobot(1), prices.FromRobot(0)) << "of one cluster";
  EXPECT_NEAR(prices.FromRobot(2), prices.FromRobot(0) + 0.5, 1e-9) << "half of what leads to two more";
  EXPECT_NEAR(prices.Between(0, 2, 4.0), prices.Between(0, 1, 4.0) + 0.5, 1e-9);
  EXPECT_EQ(prices.Between(0, 2, 4.0), prices.Between(2, 0, 4.0));
}

TEST_F(StopPricesTest, ToANarrowPlaceTheRobotTurnsBeforeAndAfterTheWay) {
  const VoxelIndex narrow{0, 20, 0};
  Narrow(narrow);
  const std::vector<CoverStop> stops = {{.place = narrow, .R_WB = Heading(0.0)},
                                        {.place = {0, -20, 0}, .R_WB = Heading(0.0)}};
  const Situation its = Timed();
  const StopPrices prices(its, stops);
  const double quarter = UsualPath(TurnTime(0.5 * kPi, robot_), robot_);
  EXPECT_NEAR(prices.FromRobot(0), 2.0 * quarter, 1e-9) << "to the left and back";
  const double travel = UsualPath(TravelTime(2.0, robot_), robot_);
  EXPECT_NEAR(prices.FromRobot(1), travel, 1e-9) << "it goes sideways in the open";
  // There the robot turns twice, back it leaves what is narrow behind.
  const double back = UsualPath(TravelTime(4.0, robot_), robot_);
  EXPECT_NEAR(prices.Between(0, 1, 4.0), 0.5 * (2.0 * quarter + back), 1e-9);
}

TEST_F(StopPricesTest, ARobotThatMustFaceWhereItMovesStandsWhileItTurns) {
  robot_.drives = true;
  robot_.drive = Drive::kDifferential;
  const std::vector<CoverStop> stops = {{.place = {0, 30, 0}, .R_WB = Heading(0.0)},
                                        {.place = {0, 0, 0}, .R_WB = Heading(0.5 * kPi), .is_here = true}};
  const Situation its = Timed();
  const StopPrices prices(its, stops);
  // 1.5 s to the left, 2 s for 3 m, 1.5 s back.
  EXPECT_NEAR(prices.FromRobot(0), 5.0, 1e-9);
  EXPECT_NEAR(prices.FromRobot(1), 1.5, 1e-9) << "a turn on the spot is a turn";
  // From the one that looks along the way 3.5 s, back 5 s: a quarter turn, the way, and half a turn less one.
  EXPECT_NEAR(prices.Between(1, 0, 3.0), 0.5 * (3.5 + 1.5 + 2.0 + 2.5), 1e-9);
}

}  // namespace
}  // namespace thalweg::explorer
