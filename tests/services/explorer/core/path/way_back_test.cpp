#include "services/explorer/core/path/way_back.h"

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/polyline.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kSize;
using Changes = std::vector<VoxelChange>;

constexpr double kBody = 0.10;   // [m]
constexpr double kNeeds = 0.20;  // [m] with its margin
const Eigen::Vector3d kInTheCell{0.55, 0.65, 0.65};
const auto kInTheHall = [](const VoxelIndex& i) { return i.x >= 14; };

/// A cell and a hall, and between them a wall of 0.2 m with a hole of `edge` x `edge` voxels, of which the
/// middle is that of voxel 6.
Changes CellAndHallChanges(int edge) {
  Changes changes;
  test::Fill(changes, {{-1, -1, -1}, {41, 14, 14}}, VoxelState::kOccupied);
  test::Fill(changes, {{0, 0, 0}, {12, 13, 13}}, VoxelState::kFree);
  test::Fill(changes, {{14, 0, 0}, {40, 13, 13}}, VoxelState::kFree);
  const int low = 6 - edge / 2;
  test::Fill(changes, {{12, low, low}, {14, low + edge, low + edge}}, VoxelState::kFree);
  return changes;
}

PlanningMap CellAndHall(int edge) {
  PlanningMap map({.voxel_size = kSize, .clearance = kNeeds, .bounds = {}});
  map.Apply(CellAndHallChanges(edge));
  return map;
}

/// From the hall through the middle of the hole, by one corner; newest first.
std::vector<RigidTransform> CameThrough() {
  const Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
  return {MakeTransform(R_WB, kInTheCell), MakeTransform(R_WB, {1.65, 0.65, 0.65}),
          MakeTransform(R_WB, {3.45, 0.45, 0.65})};
}

std::vector<Eigen::Vector3d> Back(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                  const std::vector<RigidTransform>& came,
                                  const std::function<bool(const VoxelIndex&)>& leads_on) {
  return WayBack(map, TrackBack(map, p_W, came), kBody, leads_on);
}

TEST(WayBack, LeadsThroughAPassageInWhichTheBodyFitsWithoutItsMargin) {
  const std::vector<Eigen::Vector3d> path_W = Back(CellAndHall(3), kInTheCell, CameThrough(), kInTheHall);
  ASSERT_GE(path_W.size(), 2U);
  EXPECT_EQ(path_W.front(), kInTheCell);
  EXPECT_NEAR(path_W.back().x(), 1.6, 0.1) << "to the first place in the hall in which it fits with it";
  for (const Eigen::Vector3d& p_W : path_W) EXPECT_NEAR(p_W.y(), 0.65, 1e-9);
}

TEST(WayBack, GoesOnToWhereTheRobotCanGoOn) {
  const std::vector<Eigen::Vector3d> path_W =
      Back(CellAndHall(3), kInTheCell, CameThrough(), [](const VoxelIndex& i) { return i.x >= 30; });
  ASSERT_FALSE(path_W.empty());
  EXPECT_NEAR(path_W.back().x(), 3.0, 0.1);
  EXPECT_NEAR(PathLength(path_W), 2.45, 0.1);
}

TEST(WayBack, DoesNotExistWhereThePassageIsTooNarrowForTheBodyOrShut) {
  for (const int edge : {1, 0})
    EXPECT_TRUE(Back(CellAndHall(edge), kInTheCell, CameThrough(), kInTheHall).empty()) << edge;
}

TEST(WayBack, DoesNotExistWhereNoPlaceLeadsOnOrTheRobotHasNotBeenAnywhere) {
  const PlanningMap map = CellAndHall(3);
  EXPECT_TRUE(Back(map, kInTheCell, CameThrough(), [](const VoxelIndex&) { return false; }).empty());
  EXPECT_TRUE(Back(map, kInTheCell, {}, kInTheHall).empty());
}

TEST(WayBack, LeadsBesideTheTrackWhereThatCameTooNear) {
  std::vector<RigidTransform> came = CameThrough();
  came[1].translation().y() = 0.55;  // in the hole at less than 0.1 m from its side
  const PlanningMap map = CellAndHall(3);
  const std::vector<Eigen::Vector3d> path_W = Back(map, kInTheCell, came, kInTheHall);
  ASSERT_GE(path_W.size(), 2U);
  for (std::size_t n = 1; n < path_W.size(); ++n)
    EXPECT_GE(map.SegmentClearance(path_W[n - 1], path_W[n], PlanningMap::Obstacles::kOccupied, kNeeds),
              kBody - 1e-6);
}

TEST(WayBack, TakesTheShortestPathToThePassageHoweverTheRobotHasWandered) {
  std::vector<RigidTransform> came = CameThrough();
  for (int round = 0; round < 5; ++round) {
    for (const double x : {0.25, 1.05})
      came.insert(came.begin(), MakeTransform(Eigen::Matrix3d::Identity(), {x, 0.25, 0.65}));
  }
  const std::vector<Eigen::Vector3d> path_W = Back(CellAndHall(3), kInTheCell, came, kInTheHall);
  ASSERT_FALSE(path_W.empty());
  EXPECT_LT(PathLength(path_W), 1.2) << "of 1.1 m straight";
}

TEST(WayBack, MayTouchWhatTheBodyTouchesWhereItStands) {
  // At 0.05 m from the wall of the cell; from there it moves away.
  const Eigen::Vector3d near_W{0.55, 0.05, 0.65};
  EXPECT_FALSE(Back(CellAndHall(3), near_W, CameThrough(), kInTheHall).empty());
}

TEST(WayBack, TouchesNothingElseWhereItBeginsAsTheTrackDoes) {
  // Along the wall of the cell, from which it would have to keep off by 0.08 m.
  const Eigen::Vector3d near_W{0.35, 0.02, 0.65};
  std::vector<RigidTransform> came = CameThrough();
  came.insert(came.begin(), MakeTransform(Eigen::Matrix3d::Identity(), {0.85, 0.02, 0.65}));
  const VoxelBox wall{{0, -1, 0}, {12, 0, 13}};
  for (const VoxelState state : {VoxelState::kOccupied, VoxelState::kUnknown}) {
    PlanningMap map = CellAndHall(3);
    map.Apply(test::BoxOf(wall, state));
    EXPECT_TRUE(Back(map, near_W, came, kInTheHall).empty());
  }
}

TEST(WayBack, OfADrivingRobotStaysInItsPlane) {
  PlanningMap::Options options{.voxel_size = kSize, .clearance = kNeeds, .bounds = {}};
  options.half_height = 0.1;
  PlanningMap map(options);
  map.SetPlane(0.65);
  map.Apply(CellAndHallChanges(3));
  std::vector<RigidTransform> came = CameThrough();
  for (RigidTransform& T_WB : came) T_WB.translation().z() = 0.68;  // as its odometry says
  const std::vector<Eigen::Vector3d> path_W = Back(map, kInTheCell, came, kInTheHall);
  ASSERT_FALSE(path_W.empty());
  for (const Eigen::Vector3d& p_W : path_W) EXPECT_NEAR(p_W.z(), 0.65, 0.051);
}

TEST(WayBack, OfACylinderLeadsWhereItsHeightFitsWithoutItsMargin) {
  // The hole is 0.3 m high, the body without the margins of 0.1 m above and below it 0.28 and 0.4 m.
  for (const auto& [half_height, leads] : {std::pair{0.24, true}, {0.3, false}}) {
    PlanningMap::Options options{.voxel_size = kSize, .clearance = kNeeds, .bounds = {}};
    options.half_height = half_height;
    PlanningMap map(options);
    map.Apply(CellAndHallChanges(3));
    EXPECT_EQ(!Back(map, kInTheCell, CameThrough(), kInTheHall).empty(), leads) << half_height;
  }
}

TEST(FindShut, LeadsToWhereTheTrackLeavesWhatIsReached) {
  const std::optional<ShutTrack> shut =
      FindShut(CellAndHall(0), TrackBack(CellAndHall(0), kInTheCell, CameThrough()));
  ASSERT_TRUE(shut);
  EXPECT_EQ(shut->path_W.front(), kInTheCell);
  EXPECT_NEAR(shut->path_W.back().x(), 1.0, 0.06) << "0.2 m before the wall at 1.2 m";
  EXPECT_NEAR(shut->beyond_W.x(), shut->path_W.back().x() + 0.3, 0.11);
  PlanningMap open = CellAndHall(0);
  open.Apply(test::BoxOf({{12, 0, 0}, {14, 13, 13}}, VoxelState::kFree));
  EXPECT_FALSE(FindShut(open, TrackBack(open, kInTheCell, CameThrough())));
}

TEST(MostOfSpaceOn, IsFloodedFromThePartOfTheTrackThatLiesInIt) {
  const PlanningMap map = CellAndHall(3);
  const std::optional<PathSearch> most = MostOfSpaceOn(TrackBack(map, kInTheCell, CameThrough()), map);
  ASSERT_TRUE(most);
  EXPECT_TRUE(most->Reached({30, 6, 6}));
  EXPECT_FALSE(most->Reached(map.IndexOf(kInTheCell)));
  EXPECT_FALSE(MostOfSpaceOn({kInTheCell}, map)) << "the cell is less than half";
}

}  // namespace
}  // namespace thalweg::explorer
