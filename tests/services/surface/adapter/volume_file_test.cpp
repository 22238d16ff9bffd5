#include "services/surface/adapter/volume_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "services/surface/core/fused/live_surface.h"
#include "tests/services/surface/core/fused/clouds.h"

namespace thalweg::surface {
namespace {

/// Fuses a view of a sphere from a point on the x axis.
template <class Surface>
void FuseSphere(Surface& surface, double x) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(60, 60, 1.0);
  const RigidTransform T_WC = test::LookingAt({x, 0.0, 0.0}, {0, 0, 0});
  surface.Fuse(test::CloudOf(camera, T_WC,
                             [](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
                               return test::ToSphere({0.01, 0.02, 0.03}, 0.6, o, d);
                             }),
               camera, T_WC);
}
FusedSurface Sphere() {
  FusedSurface surface({.voxel_size = 0.05});
  FuseSphere(surface, -2.0);
  return surface;
}

const InspectionLimits kLimits{.distance = 1.5F, .cosine = 0.7F};

std::string FileOf(const TruncatedVolume& volume) {
  VolumeFile file(volume.voxel_size(), kLimits);
  file.Put(volume);
  return file.Bytes();
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
  const FusedSurface surface = Sphere();
  const Result<StoredVolume> read = VolumeFrom(FileOf(surface.volume()));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->volume.voxel_size(), 0.05);
  EXPECT_EQ(read->file.voxel_size(), 0.05);
  EXPECT_EQ(read->file.limits().distance, kLimits.distance);
  EXPECT_EQ(read->file.limits().cosine, kLimits.cosine);
  ExpectSame(read->volume, surface.volume());
}

TEST(VolumeFile, GoesOnFromTheOneThatWasRead) {
  LiveSurface surface({.voxel_size = 0.05}, TruncatedVolume(0.05));
  FuseSphere(surface, -2.0);
  Result<StoredVolume> read = VolumeFrom(FileOf(surface.TakeChanged()));
  ASSERT_TRUE(read) << read.error();
  FuseSphere(surface, 2.0);
  read->file.Put(surface.TakeChanged());
  const Result<StoredVolume> again = VolumeFrom(read->file.Bytes());
  ASSERT_TRUE(again) << again.error();
  // Blocks in which nothing was seen are in no file.
  std::size_t blocks = 0;
  surface.surface().volume().ForEachBlock([&](const VoxelIndex&, const TruncatedVolume::Block& block) {
    const auto known = [](const SurfaceVoxel& voxel) { return voxel.known(); };
    blocks += std::any_of(block.voxels.begin(), block.voxels.end(), known) ? 1 : 0;
  });
  EXPECT_EQ(again->volume.block_count(), blocks);
  again->volume.ForEachBlock([&](const VoxelIndex& index, const TruncatedVolume::Block& block) {
    const TruncatedVolume::Block* own = surface.surface().volume().Find(index);
    ASSERT_NE(own, nullptr);
    EXPECT_EQ(std::memcmp(block.voxels.data(), own->voxels.data(), sizeof block.voxels), 0);
  });
  EXPECT_EQ(surface.TakeChanged().block_count(), 0U);
}

TEST(VolumeFile, CutOffOrChangedAnywhereItIsRefused) {
  const std::string good = FileOf(Sphere().volume());
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
