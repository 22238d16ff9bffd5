#include "services/surface/core/fused/mesh_patches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/services/surface/core/fused/volumes.h"

namespace thalweg::surface {
namespace {

constexpr double kPatchVoxel = 0.1;
constexpr double kBlock = 0.8;  // by which a path is uncertain

struct PatchedMesh {
  SurfaceMesh mesh{InspectionLimits{}};
  MeshPatches patches;

  void Follow(const TruncatedVolume& volume, const std::vector<VoxelIndex>& changed) {
    patches.Update(mesh, mesh.Update(volume, changed));
  }
  MeshPatches::Place At(const Eigen::Vector3d& p_W) const {
    const auto nearest = patches.Nearest(mesh, p_W, kPatchVoxel);
    EXPECT_TRUE(nearest) << p_W.transpose();
    return nearest.value_or(MeshPatches::Place{});
  }
  double Between(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const {
    return MeshPatches::Paths(patches, At(a_W)).To(At(b_W));
  }
};

double DistanceToWall(int, int, int z) {
  return kPatchVoxel * (z - 2.3);
}
/// Two floors, one at z = -0.25 m, one at z = 0.95 m, solid between them.
double DistanceToTwo(int, int, int z) {
  return kPatchVoxel * std::max(-3.0 - z, z - 9.0);
}

TEST(MeshPatches, PathsOverAPlaneAreLongerByLittle) {
  const TruncatedVolume volume =
      test::VolumeOf(kPatchVoxel, DistanceToWall, {0, 0, 0}, {119, 119, 7});  // 12 m
  PatchedMesh plane;
  plane.Follow(volume, test::AllBlocks(volume));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(0.05, 11.95);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d a_W(coordinate(random), coordinate(random), 0.28);
    const Eigen::Vector3d b_W(coordinate(random), coordinate(random), 0.28);
    const auto from = plane.At(a_W);
    const auto to = plane.At(b_W);
    const double straight = static_cast<double>((from.p_W - to.p_W).norm());
    const double length = MeshPatches::Paths(plane.patches, from).To(to);
    EXPECT_LE((from.p_W.cast<double>() - a_W).norm(), 0.71 * kPatchVoxel + 1e-3) << "the nearest vertex";
    EXPECT_GE(length, straight - 1e-5);
    EXPECT_LE(length, straight / std::cos(M_PI / 8.0) + kBlock) << "as over a grid with diagonals";
  }
}

TEST(MeshPatches, PathsLeadAroundAHole) {
  TruncatedVolume volume = test::VolumeOf(kPatchVoxel, DistanceToWall);
  test::SetKnown(volume, {-8, 4, 0}, {7, 4, 7}, false);  // a slit from one side to the last third
  PatchedMesh plane;
  plane.Follow(volume, test::AllBlocks(volume));
  const double to_the_end = std::hypot(1.2, 0.35);
  EXPECT_NEAR(plane.Between({-0.35, 0.05, 0.28}, {-0.35, 0.85, 0.28}), 2.0 * to_the_end, kBlock);
  test::SetKnown(volume, {8, 4, 0}, {15, 4, 7}, false);
  plane.Follow(volume, {{1, 0, 0}});
  EXPECT_EQ(plane.Between({-0.35, 0.05, 0.28}, {-0.35, 0.85, 0.28}), std::numeric_limits<double>::infinity());
  test::SetKnown(volume, {-8, 4, 0}, {15, 4, 7}, true);
  plane.Follow(volume, {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  EXPECT_NEAR(plane.Between({-0.35, 0.05, 0.28}, {-0.35, 0.85, 0.28}), 0.8, 0.1);
}

TEST(MeshPatches, NoPathLeadsFromOneSurfaceToAnother) {
  const TruncatedVolume volume = test::VolumeOf(kPatchVoxel, DistanceToTwo);
  PatchedMesh two;
  two.Follow(volume, test::AllBlocks(volume));
  EXPECT_EQ(two.Between({0.0, 0.0, -0.25}, {0.0, 0.0, 0.95}), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(two.Between({0.0, 0.0, 0.95}, {0.5, 0.0, 0.95}), 0.5, 0.1);
  EXPECT_FALSE(two.patches.Nearest(two.mesh, {50.0, 0.0, 0.0}, kPatchVoxel)) << "no surface around";
}

TEST(MeshPatches, AfterEachUpdateHasThePathsOfAllAtOnce) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> distance(-0.1, 0.1);
  const auto rough = [&](int, int, int z) { return kPatchVoxel * (z - 2.3) + 1.5 * distance(random); };
  TruncatedVolume volume = test::VolumeOf(kPatchVoxel, rough);
  PatchedMesh kept;
  kept.Follow(volume, test::AllBlocks(volume));
  std::uniform_int_distribution<int> place(-8, 14);
  for (int k = 0; k < 40; ++k) {
    const VoxelIndex low{place(random), place(random), 0};
    test::SetKnown(volume, low, {std::min(low.x + 2, 15), std::min(low.y + 9, 15), 6}, k % 3 == 2);
    kept.Follow(volume, test::AllBlocks(volume));
    PatchedMesh whole;
    whole.Follow(volume, test::AllBlocks(volume));
    const Eigen::Vector3d start_W(-0.35, 0.05, 0.28);
    const auto from = kept.patches.Nearest(kept.mesh, start_W, kPatchVoxel);
    const auto its = whole.patches.Nearest(whole.mesh, start_W, kPatchVoxel);
    ASSERT_EQ(from.has_value(), its.has_value());
    if (!from) continue;
    ASSERT_EQ(from->p_W, its->p_W);
    const MeshPatches::Paths paths(kept.patches, *from);
    const MeshPatches::Paths expected(whole.patches, *its);
    for (const auto& [block, mesh] : kept.mesh.blocks()) {
      for (std::uint16_t i = 0; i < mesh.vertices.size(); ++i) {
        const Eigen::Vector3f p_W = mesh.vertices[i].p_W;
        ASSERT_EQ(paths.To({kept.patches.PatchesOf(block)[i], p_W}),
                  expected.To({whole.patches.PatchesOf(block)[i], p_W}));
      }
    }
  }
}

}  // namespace
}  // namespace thalweg::surface
