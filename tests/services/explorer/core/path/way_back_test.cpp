#include "services/explorer/core/path/way_back.h"

#include <gtest/gtest.h>

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
const auto kAnywhere = [](const VoxelIndex&) { return true; };
const auto kInTheHall = [](const VoxelIndex& i) { return i.x >= 14; };

void Fill(Changes& changes, const VoxelBox& box, VoxelState state) {
  const Changes more = test::BoxOf(box, state);
  changes.insert(changes.end(), more.begin(), more.end());
}

/// A cell and a hall, and between them a wall of 0.2 m with a hole of `edge` x `edge` voxels, of which the
/// middle is that of voxel 6.
PlanningMap CellAndHall(int edge, double clearance = kNeeds) {
  Changes changes;
  Fill(changes, {{-1, -1, -1}, {41, 14, 14}}, VoxelState::kOccupied);
  Fill(changes, {{0, 0, 0}, {12, 13, 13}}, VoxelState::kFree);
  Fill(changes, {{14, 0, 0}, {40, 13, 13}}, VoxelState::kFree);
  const int low = 6 - edge / 2;
  Fill(changes, {{12, low, low}, {14, low + edge, low + edge}}, VoxelState::kFree);
  PlanningMap map({.voxel_size = kSize, .clearance = clearance, .bounds = {}});
  map.Apply(changes);
  return map;
}

/// From the hall through the middle of the hole, by one corner; newest first.
std::vector<RigidTransform> CameThrough() {
  const Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
  return {MakeTransform(R_WB, kInTheCell), MakeTransform(R_WB, {1.65, 0.65, 0.65}),
          MakeTransform(R_WB, {3.45, 0.45, 0.65})};
}

TEST(WayBack, LeadsThroughAPassageInWhichTheBodyFitsWithoutItsMargin) {
  const std::vector<Eigen::Vector3d> path_W =
      WayBack(CellAndHall(3), kInTheCell, CameThrough(), kBody, kInTheHall);
  ASSERT_GE(path_W.size(), 2U);
  EXPECT_EQ(path_W.front(), kInTheCell);
  EXPECT_NEAR(path_W.back().x(), 1.6, 0.1) << "to the first place in the hall in which it fits with it";
  for (const Eigen::Vector3d& p_W : path_W) EXPECT_NEAR(p_W.y(), 0.65, 1e-9);
}

TEST(WayBack, GoesOnToWhereTheRobotCanGoOn) {
  const std::vector<Eigen::Vector3d> path_W = WayBack(CellAndHall(3), kInTheCell, CameThrough(), kBody,
                                                      [](const VoxelIndex& i) { return i.x >= 30; });
  ASSERT_FALSE(path_W.empty());
  EXPECT_NEAR(path_W.back().x(), 3.0, 0.1);
  EXPECT_NEAR(PathLength(path_W), 2.45, 0.1);
}

TEST(WayBack, DoesNotExistWhereThePassageIsTooNarrowForTheBodyOrShut) {
  for (const int edge : {1, 0})
    EXPECT_TRUE(WayBack(CellAndHall(edge), kInTheCell, CameThrough(), kBody, kInTheHall).empty()) << edge;
}

TEST(WayBack, DoesNotExistWhereNoPlaceLeadsOnOrTheRobotHasNotBeenAnywhere) {
  const PlanningMap map = CellAndHall(3);
  EXPECT_TRUE(
      WayBack(map, kInTheCell, CameThrough(), kBody, [](const VoxelIndex&) { return false; }).empty());
  EXPECT_TRUE(WayBack(map, kInTheCell, {}, kBody, kAnywhere).empty());
}

TEST(WayBack, LeadsBesideTheTrackWhereThatCameTooNear) {
  std::vector<RigidTransform> came = CameThrough();
  came[1].translation().y() = 0.55;  // in the hole at 0.06 m from its side
  const PlanningMap map = CellAndHall(3);
  const std::vector<Eigen::Vector3d> path_W = WayBack(map, kInTheCell, came, kBody, kInTheHall);
  ASSERT_GE(path_W.size(), 2U);
  for (std::size_t n = 1; n < path_W.size(); ++n)
    EXPECT_GE(map.SegmentClearance(path_W[n - 1], path_W[n], PlanningMap::Obstacles::kOccupied, kNeeds),
              kBody - 1e-6);
}

TEST(WayBack, MayTouchWhatTheBodyTouchesWhereItStands) {
  // At 0.05 m from the wall of the cell; from there it moves away.
  const Eigen::Vector3d near_W{0.55, 0.05, 0.65};
  EXPECT_FALSE(WayBack(CellAndHall(3), near_W, CameThrough(), kBody, kInTheHall).empty());
}

}  // namespace
}  // namespace thalweg::explorer
