#include "services/simulator/core/reachable.h"

#include <gtest/gtest.h>

#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

/// Two rooms, the wall between them closed.
World TwoRooms() {
  Mesh mesh = test::BoxMesh({0.03, 0.03, 0.03}, {4.03, 2.03, 2.03});
  test::AddQuad(mesh, {2.03, 0.03, 0.03}, {0, 2, 0}, {0, 0, 2});
  return {mesh, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4.1, 2.1, 2.1)}};
}

TEST(Reachable, ASheetThinnerThanAnyVoxelStillDivides) {
  const World world = TwoRooms();
  const auto reachable = ReachableVoxels(world, {1, 1, 1}, 0.02, 0.1);
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    if (reachable[i]) {
      ASSERT_LE(reachable.IndexAt(i).x, 20);
    }
  }
  EXPECT_TRUE(reachable[(VoxelIndex{19, 10, 10})]);
}

TEST(Reachable, RandomStartsAreFreeConnectedAndOneASeed) {
  const World world = TwoRooms();
  std::vector<Eigen::Vector3d> places;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const RigidTransform start = RandomStart(world, {1, 1, 1}, 0.12, 0.3, seed);
    EXPECT_GE(world.DistanceToSurface(start.translation(), 1.0), 0.3);
    EXPECT_LT(start.translation().x(), 2.03) << "in the room of the given start";
    EXPECT_NEAR(start.linear()(2, 2), 1.0, 1e-12) << "level";
    EXPECT_TRUE(start.isApprox(RandomStart(world, {1, 1, 1}, 0.12, 0.3, seed)));
    places.push_back(start.translation());
  }
  double spread = 0.0;
  for (const Eigen::Vector3d& place : places) spread = std::max(spread, (place - places.front()).norm());
  EXPECT_GT(spread, 1.0);
}

TEST(Reachable, NoPlaceForARandomStartIsAnError) {
  EXPECT_THROW(RandomStart(TwoRooms(), {1, 1, 1}, 0.12, 1.2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::simulator
