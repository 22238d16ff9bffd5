#include "services/simulator/core/truth.h"

#include <gtest/gtest.h>

#include "common/voxel/for_each_voxel.h"
#include "services/simulator/core/surface_voxels.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

using Box = Eigen::AlignedBox3d;
using Point = Eigen::Vector3d;

std::size_t Count(const TrueMap& truth, TrueVoxel kind) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) count += truth.voxels()[i] == kind;
  return count;
}

std::size_t CountReachable(const TrueMap& truth) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.reachable().size(); ++i) count += truth.reachable()[i];
  return count;
}

TEST(TrueMap, AnEmptyRoomHasExactlyItsVoxels) {
  // 21 x 16 x 13 voxels, of which the outermost are cut by the walls.
  const Box room(Point(0.03, 0.04, 0.05), Point(2.03, 1.54, 1.25));
  const World world(test::BoxMesh(room.min(), room.max()), room);
  const TrueMap truth(world, {1, 0.8, 0.6},
                      {.voxel_size = 0.1, .robot = {.radius = 0.12}, .view_range = 5.0});
  EXPECT_EQ(truth.voxels().size(), 21U * 16 * 13);
  EXPECT_EQ(Count(truth, TrueVoxel::kFree), 19U * 14 * 11);
  EXPECT_EQ(Count(truth, TrueVoxel::kSurface), 21U * 16 * 13 - 19U * 14 * 11);
  EXPECT_EQ(truth.observable_count(), truth.voxels().size());
  // Centers at 0.05 + 0.1 i with 0.12 m to either wall: i = 1..18 (0.15 to 1.91), 2..13 (0.16 to 1.42),
  // 2..10.
  EXPECT_EQ(CountReachable(truth), 18U * 12 * 9);
}

TEST(TrueMap, WallsOnVoxelBoundariesAreAmbiguousOnBothSides) {
  const Box room(Point(0, 0, 0), Point(1, 1, 1));
  const World world(test::BoxMesh(room.min(), room.max()),
                    Box(Point(-0.2, -0.2, -0.2), Point(1.2, 1.2, 1.2)));
  const TrueMap truth(world, {0.5, 0.5, 0.5},
                      {.voxel_size = 0.1, .robot = {.radius = 0.12}, .view_range = 5.0});
  EXPECT_EQ(Count(truth, TrueVoxel::kFree), 8U * 8 * 8);
  EXPECT_EQ(Count(truth, TrueVoxel::kAmbiguous), 12U * 12 * 12 - 8U * 8 * 8);
  EXPECT_EQ(Count(truth, TrueVoxel::kSurface), 0U);
}

TEST(TrueMap, BehindAClosedWallAndInsideASolidIsOutside) {
  const Box room(Point(0.03, 0.03, 0.03), Point(3.03, 2.03, 1.53));
  Mesh mesh = test::BoxMesh(room.min(), room.max());
  test::AddBox(mesh, {Point(1.53, 0.03, 0.03), Point(1.64, 2.03, 1.53)});  // from wall to wall
  test::AddBox(mesh, {Point(0.53, 0.53, 0.03), Point(1.06, 1.06, 0.57)});
  const World world(mesh, room);
  const TrueMap truth(world, {0.3, 0.3, 1.0},
                      {.voxel_size = 0.1, .robot = {.radius = 0.1}, .view_range = 5.0});
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) {
    const VoxelIndex voxel = truth.voxels().IndexAt(i);
    const bool behind = voxel.x > 16;
    const bool inside = voxel.x > 5 && voxel.x < 10 && voxel.y > 5 && voxel.y < 10 && voxel.z < 5;
    if (behind || (inside && voxel.z > 0)) {
      ASSERT_EQ(truth.voxels()[i], TrueVoxel::kOutside) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
    }
  }
  EXPECT_EQ(truth.voxels()[(VoxelIndex{15, 10, 7})], TrueVoxel::kSurface);
  EXPECT_EQ(truth.voxels()[(VoxelIndex{16, 10, 7})], TrueVoxel::kOutside) << "the wall's far side";
}

TEST(TrueMap, AGapTooNarrowForTheRobotIsSeenThroughButNotEntered) {
  const Box room(Point(0.03, 0.03, 0.03), Point(3.03, 2.03, 1.53));
  Mesh mesh = test::BoxMesh(room.min(), room.max());
  test::AddBox(mesh, {Point(1.53, 0.03, 0.03), Point(1.58, 0.93, 1.53)});
  test::AddBox(mesh, {Point(1.53, 1.13, 0.03), Point(1.58, 2.03, 1.53)});
  const World world(mesh, room);
  const TrueMap truth(world, {0.5, 1.0, 0.8},
                      {.voxel_size = 0.1, .robot = {.radius = 0.12}, .view_range = 5.0});
  for (std::size_t i = 0; i < truth.reachable().size(); ++i) {
    if (truth.reachable()[i]) {
      ASSERT_LT(truth.reachable().IndexAt(i).x, 16);
    }
  }
  EXPECT_EQ(truth.voxels()[(VoxelIndex{25, 10, 7})], TrueVoxel::kFree);
  EXPECT_EQ(truth.voxels()[(VoxelIndex{30, 10, 7})], TrueVoxel::kSurface);
  EXPECT_EQ(truth.voxels()[(VoxelIndex{17, 1, 7})], TrueVoxel::kOutside) << "beside the gap";
}

TEST(TrueMap, SeesExactlyTheFreeVoxelsThatBruteForceSees) {
  const Box room(Point(0.033, 0.047, 0.024), Point(2.43, 1.93, 1.22));
  Mesh mesh = test::BoxMesh(room.min(), room.max());
  test::AddBox(mesh, {Point(0.9, 0.4, 0.55), Point(1.9, 1.3, 0.60)});  // a table
  for (const double x : {0.95, 1.8}) test::AddBox(mesh, {Point(x, 0.45, 0.024), Point(x + 0.05, 0.5, 0.56)});
  test::AddBox(mesh, {Point(0.033, 1.5, 0.024), Point(1.2, 1.54, 0.9)});  // a screen
  test::AddBox(mesh, {Point(1.9, 1.4, 0.024), Point(2.43, 1.93, 0.7)});
  const World world(mesh, room);
  const TrueMap::Options options{.voxel_size = 0.1, .robot = {.radius = 0.12}, .view_range = 1.2};
  const TrueMap truth(world, {0.4, 0.4, 0.9}, options);
  const SurfaceVoxels surfaces(mesh, truth.voxels().box(), options.voxel_size, 1e-4);

  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < truth.reachable().size(); ++i) {
    if (truth.reachable()[i]) positions.push_back(VoxelCenter(truth.reachable().IndexAt(i), 0.1));
  }
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) {
    if (surfaces.KindOf(i) != SurfaceVoxels::Kind::kNone) continue;
    const Eigen::Vector3d center = VoxelCenter(truth.voxels().IndexAt(i), 0.1);
    const bool seen = std::any_of(positions.begin(), positions.end(), [&](const Eigen::Vector3d& p) {
      return (p - center).norm() <= options.view_range && world.InSight(p, center);
    });
    ASSERT_EQ(truth.voxels()[i] == TrueVoxel::kFree, seen) << center.transpose();
    hidden += !seen;
  }
  EXPECT_GT(hidden, 20U);
}

TEST(TrueMap, OfOneThatDrivesIsTheLayerThatItsBodySweeps) {
  const Box room(Point(0.03, 0.04, 0.05), Point(2.03, 1.54, 1.25));
  const World world(test::BoxMesh(room.min(), room.max()), room);
  const RobotModel robot{.radius = 0.12, .height = 0.4, .drives = true};
  const TrueMap truth(world, {1, 0.8, 0.45}, {.voxel_size = 0.1, .robot = robot});
  EXPECT_EQ(truth.voxels().box().min.z, 2) << "0.25 m to 0.65 m";
  EXPECT_EQ(truth.voxels().box().max.z, 7);
  EXPECT_EQ(Count(truth, TrueVoxel::kFree), 19U * 14 * 5);
  EXPECT_EQ(Count(truth, TrueVoxel::kSurface), (21U * 16 - 19U * 14) * 5);
  EXPECT_EQ(CountReachable(truth), 18U * 12);
  EXPECT_TRUE(truth.HoldsFor({0.5, 0.5, 0.45}));
  EXPECT_FALSE(truth.HoldsFor({0.5, 0.5, 0.46})) << "another plane";
  EXPECT_FALSE(truth.HoldsFor({0.06, 0.5, 0.45}));
}

struct TruthCase {
  const char* name;
  bool drives;
  std::optional<double> pitch;  ///< [rad] Empty: a gimbal pitches it.
  double lower = 0.0;           ///< [pixels] The image's middle lies that much above the camera's axis.
};
class LevelTruth : public testing::TestWithParam<TruthCase> {};

INSTANTIATE_TEST_SUITE_P(Cameras, LevelTruth,
                         testing::Values(TruthCase{"FliesUp", false, -0.3}, TruthCase{"Flies", false, 0.0},
                                         TruthCase{"FliesDown", false, 0.2, 10.0},
                                         TruthCase{"Gimballed", false, {}, 10.0},
                                         TruthCase{"DrivesUp", true, -0.3}, TruthCase{"Drives", true, 0.0},
                                         TruthCase{"DrivesDown", true, 0.2, 10.0}),
                         [](const auto& its) { return std::string(its.param.name); });

TEST_P(LevelTruth, SeesTheFreeVoxelsThatALevelCameraSeesByBruteForce) {
  const auto& [name, drives, pitch, lower] = GetParam();
  const bool gimballed = !pitch;
  const Box room(Point(0.033, 0.047, 0.024), Point(2.43, 1.93, 1.62));
  Mesh mesh = test::BoxMesh(room.min(), room.max());
  test::AddBox(mesh, {Point(0.9, 0.4, 0.85), Point(1.9, 1.3, 0.90)});     // a board
  test::AddBox(mesh, {Point(0.033, 1.5, 0.024), Point(1.2, 1.54, 0.9)});  // a screen
  test::AddBox(mesh, {Point(1.9, 1.4, 0.024), Point(2.43, 1.93, 0.7)});
  const World world(mesh, room);
  const Point start(0.4, 0.4, 0.62);
  PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 50, 1.2);
  camera.cy -= lower;
  RobotModel robot{.radius = 0.12,
                   .height = drives ? 1.1 : 0.3,
                   .attitude = gimballed ? Attitude::kGimbal : Attitude::kLevel,
                   .drives = drives,
                   .gimbal_lowest = -0.7,
                   .gimbal_highest = -0.1};
  if (!gimballed)
    robot.T_BC = MakeTransform(RotationFromYawPitch(0.0, *pitch) * BodyFromOptical(), Point(0, 0, 0.2));
  const TrueMap truth(world, start, {.voxel_size = 0.1, .robot = robot, .camera = camera, .view_range = 2.0});
  const SurfaceVoxels surfaces(mesh, truth.voxels().box(), 0.1, 1e-4);
  std::vector<Point> positions;
  for (std::size_t i = 0; i < truth.reachable().size(); ++i) {
    if (!truth.reachable()[i]) continue;
    const Point place = VoxelCenter(truth.reachable().IndexAt(i), 0.1);
    positions.emplace_back(place.x(), place.y(), drives ? start.z() : place.z());
  }
  std::size_t hidden = 0;
  std::size_t outside_the_image = 0;
  std::size_t missed = 0;  // between the rays of the fan
  std::size_t all_seen = 0;
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) {
    const VoxelIndex voxel = truth.voxels().IndexAt(i);
    if (surfaces.KindOf(i) != SurfaceVoxels::Kind::kNone) continue;
    if (drives ? truth.reachable()[i] != 0 : CubeAround(VoxelAt(start, 0.1), 1).Contains(voxel)) continue;
    const Point center = VoxelCenter(voxel, 0.1);
    bool seen = false;
    bool in_sight = false;
    for (const Point& p : positions) {
      if (seen) break;
      const double yaw = std::atan2(center.y() - p.y(), center.x() - p.x());
      const Point eye = MakeTransform(RotationFromYawPitch(yaw, 0.0), p) * robot.T_BC.translation();
      if ((eye - center).norm() > 2.0 || !world.InSight(eye, center)) continue;
      in_sight = true;
      constexpr int kPitches = 40;
      for (int n = 0; n <= (gimballed ? kPitches : 0) && !seen; ++n) {
        const double up = gimballed ? -0.7 + 0.6 * n / kPitches : 0.0;
        seen = camera.Sees((MakeTransform(RotationFromYawPitch(yaw, up), p) * robot.T_BC).inverse() * center);
      }
    }
    const bool found = truth.voxels()[i] == TrueVoxel::kFree;
    ASSERT_LE(found, seen) << center.transpose();
    missed += seen && !found;
    all_seen += seen;
    hidden += !seen;
    outside_the_image += in_sight && !seen;
  }
  EXPECT_GT(hidden, 20U);
  if (drives) {
    EXPECT_GT(outside_the_image, 20U);
  }
  EXPECT_LE(missed, all_seen / 50);
}

TEST(TrueMap, AViewRangeEndsWhatCanBeSeen) {
  // A shaft 0.2 m wide leads away from the room. The robot does not fit into it and sees only its beginning.
  const Box all(Point(0.03, 0.03, 0.03), Point(5.03, 1.03, 1.03));
  Mesh mesh = test::BoxMesh(all.min(), all.max());
  test::AddBox(mesh, {Point(1.03, 0.03, 0.03), Point(4.93, 0.43, 1.03)});
  test::AddBox(mesh, {Point(1.03, 0.63, 0.03), Point(4.93, 1.03, 1.03)});
  const World world(mesh, all);
  const TrueMap truth(world, {0.5, 0.5, 0.5},
                      {.voxel_size = 0.1, .robot = {.radius = 0.12}, .view_range = 2.05});
  int farthest = 0;
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) {
    if (truth.voxels()[i] == TrueVoxel::kFree) farthest = std::max(farthest, truth.voxels().IndexAt(i).x);
  }
  int robot = 0;
  for (std::size_t i = 0; i < truth.reachable().size(); ++i) {
    if (truth.reachable()[i]) robot = std::max(robot, truth.reachable().IndexAt(i).x);
  }
  EXPECT_EQ(farthest, robot + 20) << "2.05 m reach the center of the 20th voxel on";
}

TEST(TrueMap, ComparesVoxelByVoxel) {
  const Box room(Point(0.03, 0.03, 0.03), Point(1.03, 1.03, 1.03));
  const World world(test::BoxMesh(room.min(), room.max()), room);
  const TrueMap truth(world, {0.5, 0.5, 0.5},
                      {.voxel_size = 0.1, .robot = {.radius = 0.12}, .view_range = 5.0});
  OccupancyGrid map(0.1);
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) {
    map.Set(truth.voxels().IndexAt(i), truth.voxels()[i] == TrueVoxel::kFree ? -1.0F : 1.0F);
  }
  const double all = 11.0 * 11 * 11;
  EXPECT_EQ(truth.Compare(map).share(), 1.0);
  EXPECT_EQ(truth.Compare(map).coverage(), 1.0);
  map.Set({5, 5, 5}, 2.0F);
  map.Set({0, 5, 5}, -2.0F);
  map.Set({0, 6, 5}, OccupancyGrid::kUnknown);
  map.Set({6, 5, 5}, OccupancyGrid::kUnknown);
  map.Set({-3, 5, 5}, 1.0F);  // outside the judged region, so it is ignored
  const TrueMap::Agreement agreement = truth.Compare(map);
  EXPECT_EQ(agreement.free_wrong, 1U);
  EXPECT_EQ(agreement.free_unknown, 1U);
  EXPECT_EQ(agreement.surface_wrong, 1U);
  EXPECT_EQ(agreement.surface_unknown, 1U);
  EXPECT_NEAR(agreement.share(), 1.0 - 4.0 / all, 1e-12);
  EXPECT_NEAR(agreement.coverage(), 1.0 - 2.0 / all, 1e-12);
  EXPECT_EQ(truth.Compare(OccupancyGrid(0.1)).share(), 0.0);
  EXPECT_THROW(truth.Compare(OccupancyGrid(0.05)), std::invalid_argument);
}

TEST(TrueMap, RefusesAStartWhereTheRobotDoesNotFit) {
  const Box room(Point(0, 0, 0), Point(1, 1, 1));
  const World world(test::BoxMesh(room.min(), room.max()), room);
  EXPECT_THROW(TrueMap(world, {0.05, 0.5, 0.5}, {}), std::invalid_argument);
  EXPECT_THROW(TrueMap(world, {1.5, 0.5, 0.5}, {}), std::invalid_argument);
  EXPECT_THROW(TrueMap(world, {0.5, 0.5, 0.5}, {.voxel_size = 0.0}), std::invalid_argument);
}

/// Two rooms of 1.4 m beside each other, with a doorway of 0.6 m from floor to ceiling, and the leaf that
/// shuts it: it slides away along the wall. Walls lie amid voxels.
World RoomsWithADoor(bool with_leaf) {
  const Box rooms(Point(0.05, 0.05, 0.05), Point(2.95, 1.45, 1.05));
  Mesh mesh = test::BoxMesh(rooms.min(), rooms.max());
  test::AddBox(mesh, {Point(1.45, 0.05, 0.05), Point(1.52, 0.75, 1.05)});
  test::AddBox(mesh, {Point(1.45, 1.35, 0.05), Point(1.52, 1.45, 1.05)});
  MovingPart leaf{.at_rest_W = Box(Point(1.34, 0.74, 0.05), Point(1.37, 1.36, 1.05)),
                  .places = {{.time = 0}, {.time = 9}, {.time = 10, .offset_W = Point(0, -0.6, 0)}}};
  return {mesh, rooms, {}, with_leaf ? std::vector{leaf} : std::vector<MovingPart>{}};
}

TEST(TrueMap, WhatAPartSweepsIsAmbiguousAndTheRestAsIfItWereNotThere) {
  const Point start(0.7, 0.7, 0.55);
  const TrueMap::Options options{.voxel_size = 0.1, .robot = {.radius = 0.1}, .view_range = 5.0};
  const World world = RoomsWithADoor(true);
  ASSERT_FALSE(world.InSight(start, {2.5, 1.25, 0.55})) << "the door is shut at the beginning";
  const TrueMap truth(world, start, options);
  const TrueMap without(RoomsWithADoor(false), start, options);
  std::size_t ambiguous = 0;
  for (std::size_t i = 0; i < truth.voxels().size(); ++i) {
    const VoxelIndex voxel = truth.voxels().IndexAt(i);
    const Point center = VoxelCenter(voxel, 0.1);
    // The leaf passes x from 1.34 to 1.37 and y from 0.14 to 1.36.
    const bool swept = voxel.x == 13 && center.y() > 0.1 && center.y() < 1.4;
    if (without.voxels()[i] == TrueVoxel::kAmbiguous) continue;
    ambiguous += swept;
    EXPECT_EQ(truth.voxels()[i], swept ? TrueVoxel::kAmbiguous : without.voxels()[i]) << center.transpose();
  }
  EXPECT_GT(ambiguous, 100U);
  EXPECT_LT(truth.observable_count(), without.observable_count());
  EXPECT_TRUE(truth.Observable(VoxelAt({2.5, 0.7, 0.55}, 0.1))) << "beyond the door";
  EXPECT_TRUE(truth.HoldsFor({2.5, 0.7, 0.55}));

  OccupancyGrid map(0.1);
  const TrueMap::Agreement nothing = truth.Compare(map);
  EXPECT_EQ(nothing.free_unknown + nothing.surface_unknown, truth.observable_count());
  map.Set(VoxelAt({1.35, 0.7, 0.55}, 0.1), 3.0F);
  const TrueMap::Agreement shut = truth.Compare(map);
  EXPECT_EQ(shut.free_wrong + shut.surface_right, 0U) << "either answer is right";
}

}  // namespace
}  // namespace thalweg::simulator
