#include "services/simulator/core/moving_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace thalweg::simulator {
namespace {

using Box = Eigen::AlignedBox3d;
using Point = Eigen::Vector3d;
constexpr double kQuarter = std::numbers::pi / 2.0;

/// A leaf of 1 m along x, hinged at the origin, that opens to y from 10 to 14 s and shuts from 20 to 24 s.
MovingPart Door(double period = 0.0) {
  return {
      .at_rest_W = Box(Point(0, 0, 0), Point(1, 0.1, 2)),
      .pivot_W = Point(0, 0, 0),
      .places = {{.time = 10}, {.time = 14, .yaw = kQuarter}, {.time = 20, .yaw = kQuarter}, {.time = 24}},
      .period = period};
}

/// A cube of 1 m that moves along x from 0 to 6 m within 3 s.
MovingPart Cart(double period = 0.0) {
  return {.at_rest_W = Box(Point(0, 0, 0), Point(1, 1, 1)),
          .pivot_W = Point(0.5, 0.5, 0.5),
          .places = {{.time = 0}, {.time = 3, .offset_W = Point(6, 0, 0)}},
          .period = period};
}

Point TipAt(const MovingPart& door, double time) {
  return PoseAt(door, time) * Point(1, 0, 0);
}

TEST(MovingPart, ADoorTurnsAboutItsHingeAndStandsBeforeAndAfter) {
  for (const double time : {0.0, 10.0, 24.0, 1e5}) {
    EXPECT_TRUE(TipAt(Door(), time).isApprox(Point(1, 0, 0), 1e-12)) << time;
  }
  for (const double time : {14.0, 17.0, 20.0}) {
    EXPECT_TRUE(TipAt(Door(), time).isApprox(Point(0, 1, 0), 1e-12)) << time;
  }
  for (const double share : {0.25, 0.5, 0.9}) {
    const Point tip(std::cos(share * kQuarter), std::sin(share * kQuarter), 0);
    EXPECT_TRUE(TipAt(Door(), 10.0 + 4.0 * share).isApprox(tip, 1e-12));
    EXPECT_TRUE(TipAt(Door(), 24.0 - 4.0 * share).isApprox(tip, 1e-12));
    const Point hinge = PoseAt(Door(), 10.0 + 4.0 * share) * Point(0, 0, 1.3);
    EXPECT_TRUE(hinge.isApprox(Point(0, 0, 1.3), 1e-12));
  }
}

TEST(MovingPart, TheShiftFollowsTheTurnAboutAPivotAnywhere) {
  const MovingPart part{.at_rest_W = Box(Point(2, 0, 0), Point(3, 1, 1)),
                        .pivot_W = Point(2, 0, 7),
                        .places = {{.time = 0, .yaw = kQuarter, .offset_W = Point(0, 10, 1)}},
                        .period = 0.0};
  EXPECT_TRUE((PoseAt(part, 5.0) * Point(3, 0, 0)).isApprox(Point(2, 11, 1), 1e-12));
}

TEST(MovingPart, ATimetableWithAPeriodBeginsAgain) {
  for (const double time : {0.0, 11.0, 17.0, 22.5, 29.9}) {
    for (const int round : {1, 2, 1000}) {
      EXPECT_TRUE(PoseAt(Door(30.0), time + 30.0 * round).isApprox(PoseAt(Door(), time), 1e-9)) << time;
    }
  }
  EXPECT_NEAR((PoseAt(Cart(5.0), 4.0) * Point::Zero()).x(), 3.0, 1e-12) << "half of its way back";
  EXPECT_NEAR((PoseAt(Cart(), 4.0) * Point::Zero()).x(), 6.0, 1e-12);
}

TEST(MovingPart, APartWithoutPlacesRests) {
  const MovingPart part{.at_rest_W = Box(Point(0, 0, 0), Point(1, 1, 1)), .places = {}};
  EXPECT_TRUE(PoseAt(part, 12.0).isApprox(RigidTransform::Identity()));
  EXPECT_EQ(FastestOf(part), 0.0);
}

TEST(MovingPart, NoPointIsFasterThanItsFastest) {
  for (const MovingPart& part : {Door(30.0), Cart(5.0)}) {
    const double fastest = FastestOf(part);
    constexpr double kStep = 0.01;
    double greatest = 0.0;
    for (double time = 0.0; time < 60.0; time += kStep) {
      for (const Point& corner : {part.at_rest_W.min(), part.at_rest_W.max()}) {
        const double way = (PoseAt(part, time + kStep) * corner - PoseAt(part, time) * corner).norm();
        greatest = std::max(greatest, way / kStep);
      }
    }
    EXPECT_LE(greatest, fastest + 1e-9);
    EXPECT_GE(greatest, 0.9 * fastest) << "the bound is not loose";
  }
}

TEST(MovingPart, ItsPosesAreVisitedWithoutAGap) {
  for (const MovingPart& part : {Door(30.0), Cart(5.0)}) {
    std::optional<RigidTransform> before;
    double most = 0.0;
    std::size_t count = 0;
    VisitPoses(part, 0.05, [&](const RigidTransform& T_WP) {
      ++count;
      for (const Point& corner : {part.at_rest_W.min(), part.at_rest_W.max()}) {
        if (before) most = std::max(most, (T_WP * corner - *before * corner).norm());
      }
      before = T_WP;
    });
    EXPECT_LE(most, 0.05 + 1e-12);
    EXPECT_GT(count, 50U);
  }
}

/// Advances in steps of 20 ms for some seconds with the robot at a place.
void Pass(PartInMotion& part, double seconds, const RobotModel& robot, const Point& p_W) {
  for (int n = 0; n < static_cast<int>(seconds / 0.02 + 0.5); ++n) part.Advance(0.02, robot, p_W);
}

const Point kFarAway(50, 50, 50);

TEST(PartInMotion, FollowsItsTimetableWhereNobodyIsInItsWay) {
  PartInMotion door(Door());
  for (const double time : {5.0, 12.0, 15.0, 22.0, 30.0}) {
    Pass(door, time - door.clock(), {}, kFarAway);
    EXPECT_NEAR(door.clock(), time, 1e-9);
    EXPECT_TRUE(door.T_WP().isApprox(PoseAt(Door(), time), 1e-9));
    EXPECT_FALSE(door.waits());
  }
}

TEST(PartInMotion, WaitsBeforeTheRobotAndGoesOnWhenItHasLeft) {
  for (const double height : {0.0, 0.4}) {
    const RobotModel robot{.radius = 0.2, .height = height};
    PartInMotion cart(Cart());
    const Point there(4.0, 0.5, 0.5);
    Pass(cart, 10.0, robot, there);
    EXPECT_TRUE(cart.waits());
    // Its front is at 1 + offset; it stands where the next step of at most 1 cm would come within 5 cm.
    const double front = (cart.T_WP() * Point(1, 0.5, 0.5)).x();
    EXPECT_LE(front, 4.0 - 0.2 - PartInMotion::kKeepOff + 1e-9);
    EXPECT_GE(front, 4.0 - 0.2 - PartInMotion::kKeepOff - 0.04);
    EXPECT_GE(cart.DistanceTo(robot, there), PartInMotion::kKeepOff - 1e-9);
    const double clock = cart.clock();
    Pass(cart, 1.0, robot, kFarAway);
    EXPECT_FALSE(cart.waits());
    EXPECT_NEAR(cart.clock(), clock + 1.0, 1e-9) << "as if no time had passed meanwhile";
  }
}

TEST(PartInMotion, IsStoppedByARobotThatItWouldPassWithinOneStep) {
  MovingPart fast = Cart();
  fast.places[1].time = 0.01;  // 600 m/s
  PartInMotion cart(fast);
  Pass(cart, 1.0, {.radius = 0.2}, {4.0, 0.5, 0.5});
  EXPECT_TRUE(cart.waits());
  EXPECT_LT(cart.T_WP().translation().x(), 3.0);
}

TEST(PartInMotion, MovesAwayFromARobotThatIsNearAndPastOneBesideIt) {
  const RobotModel robot{.radius = 0.2};
  PartInMotion cart(Cart());
  Pass(cart, 3.0, robot, {-0.21, 0.5, 0.5});  // 1 cm behind it
  EXPECT_NEAR(cart.T_WP().translation().x(), 6.0, 1e-9);
  PartInMotion passing(Cart());
  Pass(passing, 3.0, robot, {3.0, 1.23, 0.5});  // 3 cm beside its way: it would come nearer
  EXPECT_TRUE(passing.waits());
  PartInMotion clear(Cart());
  Pass(clear, 3.0, robot, {3.0, 1.26, 0.5});
  EXPECT_NEAR(clear.T_WP().translation().x(), 6.0, 1e-9);
}

TEST(PartInMotion, NoAdvanceMovesItFartherThanItSays) {
  PartInMotion door(Door(30.0));
  for (int n = 0; n < 3000; ++n) {
    const RigidTransform before = door.T_WP();
    const double most = door.Advance(0.02, {}, {0.3, 0.8, 1.0});  // in its way
    for (const Point& corner : {Point(0, 0, 0), Point(1, 0.1, 2), Point(1, 0, 0)}) {
      ASSERT_LE((door.T_WP() * corner - before * corner).norm(), most + 1e-12);
    }
  }
}

TEST(PartInMotion, RaysMeetItsSidesWhereTheyAreNow) {
  PartInMotion door(Door());
  const Point from(0.5, -2.0, 1.0);
  auto met = door.CastRay(from, Point::UnitY(), 10.0);
  ASSERT_TRUE(met);
  EXPECT_NEAR(met->distance, 2.0, 1e-12);
  EXPECT_TRUE(met->normal_W.isApprox(-Point::UnitY()));
  EXPECT_TRUE(met->at_rest_W.isApprox(Point(0.5, 0, 1)));
  EXPECT_FALSE(door.CastRay(from, Point::UnitY(), 1.9));
  EXPECT_FALSE(door.CastRay(from, -Point::UnitY(), 10.0));
  met = door.CastRay({0.5, 0.04, 1.0}, Point::UnitY(), 10.0);
  ASSERT_TRUE(met) << "from within";
  EXPECT_NEAR(met->distance, 0.06, 1e-12);
  EXPECT_TRUE(met->normal_W.isApprox(-Point::UnitY())) << "facing the origin of the ray";

  Pass(door, 16.0, {}, kFarAway);  // open: it fills x from -0.1 to 0, y from 0 to 1
  EXPECT_FALSE(door.CastRay(from, Point::UnitY(), 10.0));
  met = door.CastRay({-2.0, 0.4, 1.0}, Point::UnitX(), 10.0);
  ASSERT_TRUE(met);
  EXPECT_NEAR(met->distance, 1.9, 1e-9);
  EXPECT_TRUE(met->normal_W.isApprox(-Point::UnitX(), 1e-9));
  EXPECT_TRUE(met->at_rest_W.isApprox(Point(0.4, 0.1, 1), 1e-9)) << "the pattern travels along";
}

TEST(PartInMotion, DistancesAreThoseToASolid) {
  const PartInMotion door(Door());
  EXPECT_NEAR(door.DistanceTo({2.0, 0.05, 1.0}), 1.0, 1e-12);
  EXPECT_EQ(door.DistanceTo({0.5, 0.05, 1.0}), 0.0);
  EXPECT_NEAR(door.DistanceTo({.radius = 0.2}, {0.5, 0.5, 1.0}), 0.2, 1e-12);
  EXPECT_NEAR(door.DistanceTo({.radius = 0.2}, {0.5, 0.05, 1.0}), -0.2, 1e-12);
  EXPECT_NEAR(door.DistanceTo({.radius = 0.2, .height = 0.4}, {0.5, 0.5, 2.3}), 0.2, 1e-12);
}

}  // namespace
}  // namespace thalweg::simulator
