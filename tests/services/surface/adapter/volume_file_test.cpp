#include "services/surface/adapter/volume_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/services/surface/core/fused/clouds.h"

namespace thalweg::surface {
namespace {

/// A sphere, seen from one or two sides.
FusedSurface Sphere(int views) {
  FusedSurface surface({.voxel_size = 0.05});
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(60, 60, 1.0);
  for (int k = 0; k < views; ++k) {
    const RigidTransform T_WC = test::LookingAt({k == 0 ? -2.0 : 2.0, 0.0, 0.0}, {0, 0, 0});
    surface.Fuse(test::CloudOf(camera, T_WC,
                               [](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
                                 return test::ToSphere({0.01, 0.02, 0.03}, 0.6, o, d);
                               }),
                 camera, T_WC);
  }
  return surface;
}

std::vector<VoxelIndex> BlocksOf(const TruncatedVolume& volume) {
  std::vector<VoxelIndex> blocks;
  volume.ForEachBlock([&](const VoxelIndex& index, const auto&) { blocks.push_back(index); });
  return blocks;
}

std::string FileOf(const TruncatedVolume& volume) {
  VolumeFile file;
  file.Update(volume, BlocksOf(volume));
  return file.Bytes(volume.voxel_size());
}

void ExpectSame(const TruncatedVolume& a, const TruncatedVolume& b) {
  ASSERT_EQ(a.block_count(), b.block_count());
  a.ForEachBlock([&](const VoxelIndex& index, const TruncatedVolume::Block& block) {
    const TruncatedVolume::Block* other = b.Find(index);
    ASSERT_NE(other, nullptr);
    EXPECT_EQ(std::memcmp(block.voxels.data(), other->voxels.data(), sizeof block.voxels), 0);
    EXPECT_EQ(block.has_inside, other->has_inside);
  });
}

TEST(VolumeFile, IsReadBackBitByBit) {
  const FusedSurface surface = Sphere(1);
  const Result<TruncatedVolume> read = VolumeFrom(FileOf(surface.volume()));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->voxel_size(), 0.05);
  ExpectSame(*read, surface.volume());
}

TEST(VolumeFile, AfterAnUpdateOfWhatChangedHoldsTheWhole) {
  FusedSurface surface({.voxel_size = 0.05});
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(60, 60, 1.0);
  VolumeFile file;
  for (const double x : {-2.0, 2.0}) {
    const RigidTransform T_WC = test::LookingAt({x, 0.0, 0.0}, {0, 0, 0});
    const auto changed = surface.Fuse(test::CloudOf(camera, T_WC,
                                                    [](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
                                                      return test::ToSphere({0.01, 0.02, 0.03}, 0.6, o, d);
                                                    }),
                                      camera, T_WC);
    file.Update(surface.volume(), changed);
  }
  const Result<TruncatedVolume> read = VolumeFrom(file.Bytes(0.05));
  ASSERT_TRUE(read) << read.error();
  read->ForEachBlock([&](const VoxelIndex& index, const TruncatedVolume::Block& block) {
    const TruncatedVolume::Block* own = surface.volume().Find(index);
    ASSERT_NE(own, nullptr);
    EXPECT_EQ(std::memcmp(block.voxels.data(), own->voxels.data(), sizeof block.voxels), 0);
  });
}

TEST(VolumeFile, CutOffOrChangedAnywhereItIsRefused) {
  const std::string good = FileOf(Sphere(1).volume());
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 50) {
    EXPECT_FALSE(VolumeFrom(good.substr(0, size))) << size;
  }
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 50) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    EXPECT_FALSE(VolumeFrom(bad)) << at;
  }
  EXPECT_FALSE(VolumeFrom(good + "x"));
  EXPECT_EQ(VolumeFrom("ply\n").error(), "is no surface checkpoint");
}

TEST(VolumeFile, AnAbsentFileIsNoError) {
  const auto loaded = LoadVolume("/nonexistent/checkpoint.surface");
  ASSERT_TRUE(loaded);
  EXPECT_FALSE(loaded->has_value());
}

}  // namespace
}  // namespace thalweg::surface
