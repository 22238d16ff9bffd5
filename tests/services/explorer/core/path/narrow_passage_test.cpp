#include "services/explorer/core/path/narrow_passage.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/base/angles.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kSize;

const RobotModel kRobot{.radius = 0.1};
const Eigen::Matrix3d kSideways = RotationFromYawPitch(0.5 * std::numbers::pi, 0.0);
const Eigen::Matrix3d kAhead = Eigen::Matrix3d::Identity();

/// Free space, 6 m long, with a wall at 3 m that has a hole of 0.3 x 0.3 m at y, z = 0.9 to 1.2 m.
PlanningMap RoomsJoinedByAHole() {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 21, 21}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{30, 0, 0}, {31, 21, 21}}, VoxelState::kOccupied));
  map.Apply(test::BoxOf({{30, 9, 9}, {31, 12, 12}}, VoxelState::kFree));
  return map;
}

/// A duct, 0.3 m wide, that bends from x to z.
PlanningMap DuctWithACorner() {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{-1, -1, -1}, {31, 4, 31}}, VoxelState::kOccupied));
  map.Apply(test::BoxOf({{0, 0, 0}, {30, 3, 3}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{27, 0, 0}, {30, 3, 30}}, VoxelState::kFree));
  return map;
}
const std::vector<Eigen::Vector3d> kThroughTheDuct = {
    {0.15, 0.15, 0.15}, {2.85, 0.15, 0.15}, {2.85, 0.15, 2.85}};

double AngleTo(const RigidTransform& T_WB, const Eigen::Matrix3d& R_WB) {
  return Eigen::AngleAxisd(T_WB.linear().transpose() * R_WB).angle();
}

/// The orientation required where the path passes x.
const RigidTransform& PoseAsked(const FacedPath& path, double x) {
  for (const RigidTransform& T_WB : path.T_WBs)
    if (T_WB.translation().x() >= x - 1e-9) return T_WB;
  return path.T_WBs.back();
}

TEST(IsNarrow, WhereASurfaceOneVoxelNearerThanTheMapsWouldTouchTheBody) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {20, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{10, 0, 0}, {11, 20, 20}}, VoxelState::kOccupied));  // begins at x = 1 m
  EXPECT_TRUE(IsNarrow(map, {0.81, 1.0, 1.0}, kRobot));
  EXPECT_FALSE(IsNarrow(map, {0.79, 1.0, 1.0}, kRobot));
  EXPECT_TRUE(IsNarrow(map, {0.5, 1.0, 0.19}, kRobot)) << "nothing is known below";
}

TEST(NarrowPassage, InTheOpenTheRobotIsTurnedToItsViewAllTheWay) {
  const PlanningMap map = RoomsJoinedByAHole();
  const std::vector<Eigen::Vector3d> path_W = {{0.55, 1.05, 1.05}, {2.05, 1.05, 1.05}};
  const FacedPath path = FaceNarrowPassages(map, path_W, MakeTransform(kAhead, path_W[0]), kSideways, kRobot);
  EXPECT_FALSE(path.turn_first);
  ASSERT_EQ(path.T_WBs.size(), 2U);
  EXPECT_EQ(path.T_WBs[0].linear(), kAhead) << "nothing to wait for";
  EXPECT_EQ(path.T_WBs[1].linear(), kSideways);
  EXPECT_EQ(path.T_WBs[1].translation(), path_W[1]);
}

TEST(NarrowPassage, ItFacesWhatIsOnlyWeaklyFree) {
  PlanningMap map = RoomsJoinedByAHole();
  std::vector<VoxelChange> changes = test::BoxOf({{12, 0, 0}, {16, 21, 21}}, VoxelState::kFree);
  for (VoxelChange& change : changes) change.log_odds = OccupancyGrid::kWeaklyFree;
  map.Apply(changes);
  const std::vector<Eigen::Vector3d> path_W = {{0.55, 1.05, 1.05}, {2.55, 1.05, 1.05}};
  const FacedPath path = FaceNarrowPassages(map, path_W, MakeTransform(kAhead, path_W[0]), kSideways, kRobot);
  for (const double x : {1.1, 1.5}) EXPECT_LT(AngleTo(PoseAsked(path, x), kAhead), 1e-6) << x;
  EXPECT_LT(AngleTo(path.T_WBs.back(), kSideways), 1e-6);
}

TEST(NarrowPassage, ItFacesAHoleThatItGoesThroughAndItsViewAfterwards) {
  const PlanningMap map = RoomsJoinedByAHole();
  const std::vector<Eigen::Vector3d> path_W = {{0.55, 1.05, 1.05}, {5.05, 1.05, 1.05}};
  const FacedPath path =
      FaceNarrowPassages(map, path_W, MakeTransform(kSideways, path_W[0]), kSideways, kRobot);
  EXPECT_FALSE(path.turn_first) << "there is room to turn on the way";
  EXPECT_LT(AngleTo(PoseAsked(path, 1.5), kSideways), 1e-6);
  for (const double x : {2.4, 2.8, 3.05, 3.15}) EXPECT_LT(AngleTo(PoseAsked(path, x), kAhead), 1e-6) << x;
  EXPECT_LT(AngleTo(PoseAsked(path, 3.6), kSideways), 1e-6);
  EXPECT_LT(AngleTo(path.T_WBs.back(), kSideways), 1e-6);
  for (const RigidTransform& T_WB : path.T_WBs) {
    EXPECT_NEAR(T_WB.translation().y(), 1.05, 1e-9) << "the path itself stays";
    EXPECT_NEAR(T_WB.translation().z(), 1.05, 1e-9);
  }
}

TEST(NarrowPassage, RightBeforeItTheRobotTurnsFirstUnlessItFacesItAlready) {
  const PlanningMap map = RoomsJoinedByAHole();
  const std::vector<Eigen::Vector3d> path_W = {{2.65, 1.05, 1.05}, {5.05, 1.05, 1.05}};
  const FacedPath turning =
      FaceNarrowPassages(map, path_W, MakeTransform(kSideways, path_W[0]), kSideways, kRobot);
  EXPECT_TRUE(turning.turn_first);
  EXPECT_LT(AngleTo(turning.T_WBs.front(), kAhead), 1e-6);
  const FacedPath facing =
      FaceNarrowPassages(map, path_W, MakeTransform(kAhead, path_W[0]), kSideways, kRobot);
  EXPECT_FALSE(facing.turn_first);
}

TEST(NarrowPassage, ARobotThatLeavesANarrowPlaceForTheOpenNeedNotLook) {
  const PlanningMap map = RoomsJoinedByAHole();
  const std::vector<Eigen::Vector3d> path_W = {{3.35, 1.05, 1.05}, {5.05, 1.05, 1.05}};
  const FacedPath path =
      FaceNarrowPassages(map, path_W, MakeTransform(kSideways, path_W[0]), kSideways, kRobot);
  EXPECT_FALSE(path.turn_first);
}

TEST(NarrowPassage, RoundACornerItFacesWhatComesAndIsNotTurnedBackAndForth) {
  const PlanningMap map = DuctWithACorner();
  const FacedPath path =
      FaceNarrowPassages(map, kThroughTheDuct, MakeTransform(kAhead, kThroughTheDuct[0]), kSideways, kRobot);
  EXPECT_LT(path.T_WBs.size(), 12U);
  double up = -1.0;
  for (std::size_t n = 0; n + 1 < path.T_WBs.size(); ++n) {
    const double now = path.T_WBs[n].linear().col(0).z();
    EXPECT_GE(now, up - 1e-9);
    up = now;
  }
  EXPECT_GT(up, 0.95) << "upward at last";
}

TEST(NarrowPassage, ALevelRobotFacesTheHeadingOfWhatComesAndKeepsItWhereThePathRises) {
  const PlanningMap map = DuctWithACorner();
  const RobotModel level{.radius = 0.1, .attitude = Attitude::kLevel};
  const FacedPath path = FaceNarrowPassages(map, kThroughTheDuct,
                                            MakeTransform(kSideways, kThroughTheDuct[0]), kSideways, level);
  EXPECT_TRUE(path.turn_first);
  ASSERT_GT(path.T_WBs.size(), 2U);
  for (std::size_t n = 0; n + 1 < path.T_WBs.size(); ++n) {
    EXPECT_LT(AngleTo(path.T_WBs[n], kAhead), 1e-6) << path.T_WBs[n].translation().transpose();
  }
  EXPECT_LT(AngleTo(path.T_WBs.back(), kSideways), 1e-6);
}

TEST(NarrowPassage, ARobotAtFullSpeedHasTurnedWhenItRoundsTheCornerHoweverSoonItStopsBehindIt) {
  const PlanningMap map = DuctWithACorner();
  for (const double beyond : {2.7, 0.1}) {
    std::vector<Eigen::Vector3d> path_W = kThroughTheDuct;
    path_W.back() = path_W[1] + Eigen::Vector3d(0, 0, beyond);
    const FacedPath path =
        FaceNarrowPassages(map, path_W, MakeTransform(kAhead, path_W[0]), kSideways, kRobot);
    double pitch = 0.0;  // of a robot that moves at full speed and turns as fast as it can
    for (std::size_t n = 1; n < path.T_WBs.size(); ++n) {
      const double travel = (path.T_WBs[n].translation() - path.T_WBs[n - 1].translation()).norm();
      const double asked = AngleTo(path.T_WBs[n], kAhead);
      pitch = std::min(asked, pitch + travel / kRobot.max_speed * kRobot.max_turn_rate);
      if (path.T_WBs[n].translation().isApprox(path_W[1])) break;
    }
    EXPECT_GT(pitch, 75.0 * kDegree) << beyond;
  }
}

TEST(NarrowPassage, ItSaysWhereTheRobotMustFaceThePath) {
  const PlanningMap map = RoomsJoinedByAHole();
  const std::vector<Eigen::Vector3d> path_W = {{0.55, 1.05, 1.05}, {5.05, 1.05, 1.05}};
  const FacedPath path =
      FaceNarrowPassages(map, path_W, MakeTransform(kSideways, path_W[0]), kSideways, kRobot);
  ASSERT_EQ(path.narrow.size(), path.T_WBs.size());
  const auto narrow_at = [&](double x) {
    std::size_t n = 0;
    while (path.T_WBs[n].translation().x() < x) ++n;
    return path.narrow[n];
  };
  for (const double x : {1.5, 2.5, 3.5, 4.5}) EXPECT_FALSE(narrow_at(x)) << x;
  for (const double x : {2.85, 3.05}) EXPECT_TRUE(narrow_at(x)) << x;
}

TEST(NarrowPassage, ItIsTurnedBeforeAHoleHoweverFarItHasToTurn) {
  const PlanningMap map = RoomsJoinedByAHole();
  const std::vector<Eigen::Vector3d> path_W = {{0.55, 1.05, 1.05}, {3.45, 1.05, 1.05}};
  for (const double view : {0.25, 0.5, 0.75, 1.0}) {
    const Eigen::Matrix3d R_WB_end = RotationFromYawPitch(view * std::numbers::pi, 0.0);
    for (const double turn_rate : {0.8, 1.6, 3.2}) {
      RobotModel robot = kRobot;
      robot.max_turn_rate = turn_rate;
      const FacedPath path =
          FaceNarrowPassages(map, path_W, MakeTransform(R_WB_end, path_W[0]), R_WB_end, robot);
      RigidTransform T_WB = MakeTransform(R_WB_end, path_W[0]);  // at full speed, turning as fast as it can
      for (const RigidTransform& asked : path.T_WBs) {
        while (T_WB.translation().x() < std::min(2.75, asked.translation().x()) - 1e-9) {
          const double step = 0.01;
          T_WB.translation().x() += step;
          T_WB = TurnedTowards(T_WB, asked, step / robot.max_speed * turn_rate);
        }
      }
      EXPECT_LT(AngleTo(T_WB, kAhead), 0.01) << view << ' ' << turn_rate;
    }
  }
}

TEST(NarrowPassage, ASlowlyTurningRobotIsAskedToFaceThePathToo) {
  const PlanningMap map = DuctWithACorner();
  for (const double turn_rate : {0.2, 0.8, 1.6}) {
    RobotModel robot = kRobot;
    robot.max_turn_rate = turn_rate;
    const FacedPath path =
        FaceNarrowPassages(map, kThroughTheDuct, MakeTransform(kAhead, kThroughTheDuct[0]), kSideways, robot);
    int narrow = 0;
    for (std::size_t n = 1; n + 1 < path.T_WBs.size(); ++n) {
      if (!path.narrow[n]) continue;
      ++narrow;
      Eigen::Vector3d ahead = Eigen::Vector3d::Zero();  // the direction of the path ahead
      for (std::size_t m = n; m < path.T_WBs.size() && ahead.norm() < 0.3; ++m)
        ahead = path.T_WBs[m].translation() - path.T_WBs[n - 1].translation();
      const double cosine = ahead.normalized().dot(path.T_WBs[n].linear().col(0));
      EXPECT_GT(cosine, 0.5) << turn_rate << " rad/s, pose " << n;
    }
    EXPECT_GT(narrow, 3);
  }
}

TEST(FaceTravelThenTurn, FacesEachSegmentAndThenTheView) {
  const RigidTransform T_WB = MakeTransform(kSideways, {1, 1, 1});
  const FacedPath path = FaceTravelThenTurn({{1, 1, 1}, {3, 1, 1}, {3, 2, 1}, {2, 2, 1}}, T_WB, kAhead);
  ASSERT_EQ(path.T_WBs.size(), 5U);
  EXPECT_EQ(path.narrow, std::vector<bool>(5, false));
  EXPECT_FALSE(path.turn_first);
  EXPECT_LT(AngleTo(path.T_WBs[1], kAhead), 1e-9);
  EXPECT_LT(AngleTo(path.T_WBs[2], kSideways), 1e-9);
  EXPECT_LT(AngleTo(path.T_WBs[3], RotationFromYawPitch(std::numbers::pi, 0.0)), 1e-9);
  EXPECT_EQ(path.T_WBs[4].translation(), path.T_WBs[3].translation());
  EXPECT_EQ(path.T_WBs[4].linear(), kAhead);
  EXPECT_EQ(FaceTravelThenTurn({{1, 1, 1}}, T_WB, kAhead).T_WBs.size(), 1U);
}

TEST(NarrowPassage, APathOfOnePlaceIsItsView) {
  const PlanningMap map = RoomsJoinedByAHole();
  const Eigen::Vector3d p_W{3.05, 1.05, 1.05};
  const FacedPath path = FaceNarrowPassages(map, {p_W}, MakeTransform(kAhead, p_W), kSideways, kRobot);
  ASSERT_EQ(path.T_WBs.size(), 1U);
  EXPECT_EQ(path.T_WBs[0].linear(), kSideways);
  EXPECT_FALSE(path.turn_first);
}

}  // namespace
}  // namespace thalweg::explorer
