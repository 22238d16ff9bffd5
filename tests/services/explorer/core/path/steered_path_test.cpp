#include "services/explorer/core/path/steered_path.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/geometry/attitude.h"
#include "common/geometry/polyline.h"
#include "services/explorer/core/path/path_search.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

constexpr double kWheels = 0.35;   // [m]
constexpr double kTightest = 0.5;  // [m] The tightest curve's radius.
constexpr SteeringModel kCar{
    .min_turning_radius = kTightest, .body_radius = 0.1, .exemption = 0.3, .wide_exemption = 0.3};
constexpr auto kNotFree = PlanningMap::Obstacles::kOccupiedAndUnknown;

PlanningMap DrivenMap(const std::vector<VoxelChange>& changes) {
  PlanningMap map(
      {.voxel_size = test::kSize, .clearance = test::kClearance, .half_height = 0.2, .bounds = std::nullopt});
  map.SetPlane(kWheels);
  map.Apply(changes);
  return map;
}

/// A room of `length` x `width` [voxels] with walls.
PlanningMap Room(int length, int width) {
  return DrivenMap(test::ClosedRoom({{0, 0, 0}, {length, width, 8}}));
}

RigidTransform Pose(double x, double y, double yaw) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), {x, y, kWheels});
}

/// Whether the robot moves back on the way from one pose to the next.
bool GoesBack(const RigidTransform& from, const RigidTransform& to) {
  return (to.translation() - from.translation()).dot(to.linear().col(0)) < 0.0;
}

/// How often the robot changes over between forward and back.
int ChangesIn(const std::vector<RigidTransform>& T_WBs) {
  int changes = 0;
  for (std::size_t n = 2; n < T_WBs.size(); ++n)
    changes += GoesBack(T_WBs[n - 2], T_WBs[n - 1]) != GoesBack(T_WBs[n - 1], T_WBs[n]) ? 1 : 0;
  return changes;
}

/// Expects that a car can drive the path: on each piece its heading is, in the mean, that of the chord, and
/// changes no more than the tightest curve allows; and that its body stays clear.
void ExpectDrivable(const std::vector<RigidTransform>& T_WBs, const PlanningMap& map) {
  for (std::size_t n = 1; n < T_WBs.size(); ++n) {
    const RigidTransform& from = T_WBs[n - 1];
    const RigidTransform& to = T_WBs[n];
    const Eigen::Vector3d chord_W = to.translation() - from.translation();
    const double turn = AngleBetween(from, to);
    ASSERT_GT(chord_W.norm(), 1e-6) << "it cannot turn on the spot";
    EXPECT_LE(turn, 0.101);
    EXPECT_LE(2.0 * std::sin(0.5 * turn) / chord_W.norm(), 1.0 / kTightest) << n;
    const Eigen::Vector3d mean_W = Interpolate(from, to, 0.5).linear().col(0);
    EXPECT_NEAR(std::abs(mean_W.dot(chord_W.normalized())), 1.0, 1e-9) << n;
    EXPECT_TRUE(map.SegmentClear(from.translation(), to.translation(), kNotFree, test::kClearance - 0.003))
        << n;
  }
}

TEST(SteerTo, ARobotThatIsThereStays) {
  const PlanningMap map = Room(40, 40);
  const auto path = SteerTo(map, Pose(2, 2, 0.3), {.p_W = {2.05, 2, kWheels}, .yaw = 0.25}, kCar);
  ASSERT_TRUE(path);
  ASSERT_EQ(path->size(), 1U);
  EXPECT_TRUE(path->front().isApprox(Pose(2, 2, 0.3)));
}

TEST(SteerTo, StraightAheadIsOneLineForwardAndBehindOneBack) {
  const PlanningMap map = Room(60, 40);
  const auto ahead = SteerTo(map, Pose(1, 2, 0), {.p_W = {5, 2, kWheels}, .yaw = 0.0}, kCar);
  ASSERT_TRUE(ahead);
  EXPECT_EQ(ahead->size(), 2U);
  EXPECT_NEAR(ahead->back().translation().x(), 5.0, 0.1);
  EXPECT_EQ(ahead->back().translation().y(), 2.0);
  const auto behind = SteerTo(map, Pose(2, 2, 0), {.p_W = {1.5, 2, kWheels}, .yaw = 0.0}, kCar);
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->size(), 2U);
  EXPECT_NEAR(behind->back().translation().x(), 1.5, 0.1);
}

/// The shortest way to turn about by half a turn where one stands has three arcs, which together turn by
/// that: pi R [Reeds and Shepp, Optimal paths for a car that goes both forwards and backwards, PJM 1990].
TEST(SteerTo, TurningAboutInTheOpenIsHardlyLongerThanTheShortestWay) {
  const PlanningMap map = Room(60, 60);
  const auto path = SteerTo(map, Pose(3, 3, 0), {.p_W = {3, 3, kWheels}, .yaw = std::numbers::pi}, kCar);
  ASSERT_TRUE(path);
  ExpectDrivable(*path, map);
  const double shortest = std::numbers::pi * kTightest;
  const double spared = 10.0 * kDegree * kTightest + 2 * 0.1;  // the goal's tolerances
  EXPECT_GE(PathLength(*path), shortest - spared);
  EXPECT_LE(PathLength(*path), 1.4 * shortest);
  EXPECT_GE(ChangesIn(*path), 1);
}

TEST(SteerTo, ACorridorTooNarrowToTurnInIsLeftBackward) {
  // A corridor 0.4 m wide that ends blindly, from a room.
  std::vector<VoxelChange> changes = test::ClosedRoom({{0, 0, 0}, {40, 40, 8}});
  test::Fill(changes, {{39, 16, -1}, {72, 24, 9}}, VoxelState::kOccupied);
  test::Fill(changes, {{39, 18, 0}, {71, 22, 8}}, VoxelState::kFree);
  const PlanningMap map = DrivenMap(changes);
  const RigidTransform inside = Pose(6.5, 2, 0);
  const auto out = SteerTo(map, inside, {.p_W = {2, 2, kWheels}, .yaw = std::numbers::pi}, kCar);
  ASSERT_TRUE(out);
  ExpectDrivable(*out, map);
  EXPECT_TRUE(GoesBack((*out)[0], (*out)[1]));
  EXPECT_GE(ChangesIn(*out), 1) << "and turns about in the room";
  // The same corridor without a room to turn about in.
  const PlanningMap alone = DrivenMap(test::ClosedRoom({{0, 0, 0}, {60, 3, 8}}));
  EXPECT_FALSE(SteerTo(alone, Pose(3, 0.15, 0), {.p_W = {2, 0.15, kWheels}, .yaw = std::numbers::pi}, kCar));
  EXPECT_TRUE(SteerTo(alone, Pose(3, 0.15, 0), {.p_W = {2, 0.15, kWheels}}, kCar)) << "in any heading";
}

TEST(SteerTo, InRandomRoomsItsPathsCanBeDrivenAndEndAtTheGoal) {
  std::mt19937 random(3);
  int found = 0;
  double lengths = 0.0;
  double least = 0.0;
  for (int round = 0; round < 40; ++round) {
    const PlanningMap map = DrivenMap(test::RandomScene(random, {{0, 0, 0}, {60, 60, 8}}, 14, 10));
    std::vector<VoxelIndex> places = test::TraversableVoxels(map);
    if (places.size() < 200) continue;
    const auto any = [&] {
      return places[static_cast<std::size_t>(
          test::RandomInt(random, 0, static_cast<int>(places.size()) - 1))];
    };
    const VoxelIndex from = any();
    RigidTransform start = Pose(0, 0, test::RandomDouble(random, -3.0, 3.0));
    start.translation() = map.CenterOf(from);
    start.translation().z() = kWheels;
    Eigen::Vector3d to_W = map.CenterOf(any());
    to_W.z() = kWheels;
    const double yaw = test::RandomDouble(random, -3.0, 3.0);
    PathSearch search;
    search.Flood(map, {{from, 0}});
    const auto path = SteerTo(map, start, {.p_W = to_W, .yaw = yaw}, kCar);
    if (!search.Reached(map.IndexOf(to_W))) {
      EXPECT_FALSE(path) << "where no robot of this size comes";
      continue;
    }
    if (!path) continue;
    ++found;
    ExpectDrivable(*path, map);
    EXPECT_TRUE(path->front().isApprox(start));
    EXPECT_LE((path->back().translation() - to_W).norm(), 0.1);
    EXPECT_LE(std::abs(WrappedAngle(YawOf(path->back().linear()) - yaw)), 10.0 * kDegree + 1e-9);
    lengths += PathLength(*path);
    least += (to_W - start.translation()).norm();
  }
  EXPECT_GE(found, 15) << "else this says nothing";
  EXPECT_LE(lengths, 2.0 * least + found * std::numbers::pi * kTightest);
}

TEST(SteerTo, InALargeRoomItFindsItsWayWhicheverWayItHasToTurn) {
  const PlanningMap map = Room(400, 300);
  for (const double distance : {5.0, 15.0, 30.0}) {
    for (const double facing : {0.0, std::numbers::pi}) {
      for (const double at_end : {0.0, std::numbers::pi}) {
        const auto path =
            SteerTo(map, Pose(4, 15, facing), {.p_W = {4.0 + distance, 15, kWheels}, .yaw = at_end}, kCar);
        ASSERT_TRUE(path) << distance << ", " << facing << ", " << at_end;
        // A turn about at either end takes half a circle and the way back to the line.
        const double turns = (facing + at_end) / std::numbers::pi;
        EXPECT_LE(PathLength(*path), 1.05 * distance + turns * 2.0 * std::numbers::pi * kTightest);
      }
    }
  }
}

TEST(SteerTo, ARobotComesBackToWhereItStoodAlthoughItIsNotClearThere) {
  const PlanningMap map = Room(40, 40);
  SteeringGoal home{.p_W = {0.05, 2, kWheels}};
  EXPECT_FALSE(SteerTo(map, Pose(2, 2, 0), home, kCar));
  home.p_W.x() = 0.12;
  home.distance = 0.01;
  EXPECT_FALSE(SteerTo(map, Pose(2, 2, 0), home, kCar));
  home.was_there = true;
  EXPECT_TRUE(SteerTo(map, Pose(2, 2, 0), home, kCar));
}

TEST(SteerTo, ARobotThatStandsTooNearToAWallDrivesAway) {
  const PlanningMap map = Room(40, 40);
  const RigidTransform near =
      Pose(0.12, 2, 0.5 * std::numbers::pi);  // clear of the wall by less than its margin
  EXPECT_TRUE(SteerTo(map, near, {.p_W = {2, 2, kWheels}}, kCar));
  SteeringModel strict = kCar;
  strict.exemption = strict.wide_exemption = 0.0;
  EXPECT_FALSE(SteerTo(map, near, {.p_W = {2, 2, kWheels}}, strict));
}

}  // namespace
}  // namespace thalweg::explorer
