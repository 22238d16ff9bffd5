#include "services/simulator/core/reachable.h"

#include <gtest/gtest.h>

#include "common/voxel/voxels_within.h"
#include "services/simulator/core/upright_cylinder.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

/// Two rooms with a closed wall between them.
World TwoRooms() {
  Mesh mesh = test::BoxMesh({0.03, 0.03, 0.03}, {4.03, 2.03, 2.03});
  test::AddQuad(mesh, {2.03, 0.03, 0.03}, {0, 2, 0}, {0, 0, 2});
  return {mesh, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4.1, 2.1, 2.1)}};
}

TEST(Reachable, ASheetThinnerThanAnyVoxelStillDivides) {
  const World world = TwoRooms();
  const auto reachable = ReachableVoxels(world, {1, 1, 1}, {.radius = 0.02}, 0.1);
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    if (reachable[i]) {
      ASSERT_LE(reachable.IndexAt(i).x, 20);
    }
  }
  EXPECT_TRUE(reachable[(VoxelIndex{19, 10, 10})]);
}

constexpr double kVoxel = 0.1;

/// By brute force: the voxels in whose places the cylinder fits and that are connected to the start.
DenseGrid<std::uint8_t> Flooded(const World& world, const Eigen::Vector3d& start, const RobotModel& robot) {
  DenseGrid<std::uint8_t> fits(VoxelsWithin(ExploredBounds(robot, start, world.bounds()), kVoxel), 0);
  const VoxelIndex first = VoxelAt(start, kVoxel);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const VoxelIndex voxel = fits.IndexAt(i);
    if (robot.drives && voxel.z != first.z) continue;
    Eigen::Vector3d p = VoxelCenter(voxel, kVoxel);
    if (robot.drives) p.z() = start.z();
    const UprightCylinder body{p, robot.radius, robot.height};
    bool free = true;
    for (std::uint32_t n = 0; n < world.mesh().triangles.size() && free; ++n) {
      free = Distance(body, TriangleOf(world.mesh(), n), 1.0) >= 0.0;
    }
    for (const Eigen::AlignedBox3d& box : world.no_go()) free = free && Distance(body, box) >= 0.0;
    fits[i] = free;
  }
  DenseGrid<std::uint8_t> reached(fits.box(), 0);
  std::vector<VoxelIndex> open;  // it may fit at the start but not at the place in that voxel
  for (int n = 0; n < 27; ++n) open.push_back(first + VoxelIndex{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1});
  while (!open.empty()) {
    const VoxelIndex voxel = open.back();
    open.pop_back();
    if (!fits.Get(voxel, 0) || reached[voxel]) continue;
    reached[voxel] = 1;
    for (const VoxelIndex& step : kFaceNeighbors) open.push_back(voxel + step);
  }
  return reached;
}

/// A room with a low box, a table, a doorway with a lintel, and a no-go box.
World FurnishedRoom() {
  Mesh mesh = test::BoxMesh({0.03, 0.03, 0.03}, {4.03, 2.53, 2.03});
  test::AddBox(mesh, {Eigen::Vector3d(0.4, 1.5, 0.03), Eigen::Vector3d(1.0, 2.2, 0.17)});
  test::AddBox(mesh, {Eigen::Vector3d(1.2, 0.5, 0.64), Eigen::Vector3d(1.9, 1.3, 0.68)});
  test::AddBox(mesh, {Eigen::Vector3d(2.5, 0.03, 0.03), Eigen::Vector3d(2.6, 0.8, 2.03)});
  test::AddBox(mesh, {Eigen::Vector3d(2.5, 1.5, 0.03), Eigen::Vector3d(2.6, 2.53, 2.03)});
  test::AddBox(mesh, {Eigen::Vector3d(2.5, 0.8, 1.1), Eigen::Vector3d(2.6, 1.5, 2.03)});
  return {mesh,
          {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4.1, 2.6, 2.1)},
          {{Eigen::Vector3d(3.4, 0.0, 0.0), Eigen::Vector3d(4.1, 0.9, 0.5)}}};
}

TEST(Reachable, ACylinderGoesWhereABruteForceFloodSays) {
  const World world = FurnishedRoom();
  for (const double height : {0.3, 0.5, 1.3}) {
    for (const bool drives : {false, true}) {
      for (const double z : {0.39, 0.72}) {
        const Eigen::Vector3d start(0.55, 0.55, z);
        const RobotModel robot{.radius = 0.17, .height = height, .drives = drives};
        if (z - 0.5 * height < 0.03) {
          EXPECT_THROW(ReachableVoxels(world, start, robot, kVoxel), std::invalid_argument);
          continue;
        }
        const auto reachable = ReachableVoxels(world, start, robot, kVoxel);
        const auto expected = Flooded(world, start, robot);
        ASSERT_EQ(reachable.box(), expected.box());
        std::size_t count = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
          ASSERT_EQ(reachable[i], expected[i]) << height << drives << z << ' ' << i;
          count += expected[i];
        }
        EXPECT_GT(count, 100U);
      }
    }
  }
}

TEST(Reachable, OneThatDrivesIsJudgedAtItsOwnHeight) {
  const World world = FurnishedRoom();
  const VoxelIndex over_the_box{7, 18, 3};  // the low box is 0.17 m high; the voxel's center is at 0.35 m
  const RobotModel robot{.radius = 0.17, .height = 0.4, .drives = true};
  EXPECT_TRUE(ReachableVoxels(world, {0.5, 0.5, 0.39}, robot, kVoxel)[over_the_box]);
  EXPECT_FALSE(ReachableVoxels(world, {0.5, 0.5, 0.35}, robot, kVoxel)[over_the_box]);
}

TEST(Reachable, RandomStartsOfOneThatDrivesAreInThePlaneOfTheGivenOne) {
  const World world = FurnishedRoom();
  const RobotModel robot{.radius = 0.17, .height = 0.4, .drives = true};
  const auto places = StartPlaces(world, {0.55, 0.55, 0.37}, robot, 0.3);
  EXPECT_GT(places.size(), 50U);
  RobotModel wide = robot;
  wide.radius = 0.3;
  for (const Eigen::Vector3d& place : places) {
    ASSERT_EQ(place.z(), 0.37);
    ASSERT_GE(world.ClearanceOf(wide, place, 1.0), 0.0);
  }
}

TEST(Reachable, RandomStartsAreFreeConnectedAndOneASeed) {
  const World world = TwoRooms();
  std::vector<Eigen::Vector3d> places;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const RigidTransform start = RandomStart(world, {1, 1, 1}, {.radius = 0.12}, 0.3, seed);
    EXPECT_GE(world.DistanceToSurface(start.translation(), 1.0), 0.3);
    EXPECT_LT(start.translation().x(), 2.03) << "in the room of the given start";
    EXPECT_NEAR(start.linear()(2, 2), 1.0, 1e-12) << "level";
    EXPECT_TRUE(start.isApprox(RandomStart(world, {1, 1, 1}, {.radius = 0.12}, 0.3, seed)));
    places.push_back(start.translation());
  }
  double spread = 0.0;
  for (const Eigen::Vector3d& place : places) spread = std::max(spread, (place - places.front()).norm());
  EXPECT_GT(spread, 1.0);
}

TEST(Reachable, NoPlaceForARandomStartIsAnError) {
  EXPECT_THROW(RandomStart(TwoRooms(), {1, 1, 1}, {.radius = 0.12}, 1.2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::simulator
