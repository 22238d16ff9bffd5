#include "services/surface/core/fused/surface_mesh.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/services/surface/core/fused/clouds.h"
#include "tests/services/surface/core/fused/volumes.h"

namespace thalweg::surface {
namespace {

using Point = Eigen::Vector3d;

using test::AllBlocks;
using test::VolumeOf;

TEST(SurfaceMesh, IsClosedAroundWhateverIsInside) {
  // Random signs: every case of a cell, and of its ambiguous faces, occurs. The outermost voxels are outside.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> distance(-1.0, 1.0);
  const TruncatedVolume volume = VolumeOf(1.0, [&](int x, int y, int z) {
    const bool is_border = std::min({x, y, z}) == -8 || std::max({x, y, z}) == 15;
    return is_border ? 0.5 : distance(random);
  });
  SurfaceMesh mesh({});
  mesh.Update(volume, AllBlocks(volume));
  const TriangleMesh joined = mesh.Joined();
  ASSERT_GT(joined.faces.size(), 5000U);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& face : joined.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++sides[{face[k], face[(k + 1) % 3]}];
      --sides[{face[(k + 1) % 3], face[k]}];
    }
  }
  for (const auto& [side, excess] : sides) EXPECT_EQ(excess, 0) << "each side has its opposite";
}

TEST(SurfaceMesh, FacesFreeSpace) {
  const TruncatedVolume volume = VolumeOf(0.1, [](int, int, int z) { return 0.1 * (z - 2.3); });
  SurfaceMesh mesh({});
  mesh.Update(volume, AllBlocks(volume));
  const TriangleMesh joined = mesh.Joined();
  for (const auto& [a, b, c] : joined.faces) {
    const Eigen::Vector3f p = joined.vertices_W[a];
    EXPECT_GT((joined.vertices_W[b] - p).cross(joined.vertices_W[c] - p).z(), 0.0F);
    EXPECT_NEAR(p.z(), 0.1 * (2.3 + 0.5), 1e-6) << "voxels' values hold for their centers";
  }
  for (const Eigen::Vector3f& normal : joined.normals_W) EXPECT_NEAR(normal.z(), 1.0, 1e-5);
  EXPECT_NEAR(test::AreaOf(joined), 2.3 * 2.3, 1e-4) << "between the centers of the outermost of 24 voxels";
}

TEST(SurfaceMesh, AfterEachUpdateEqualsTheWholeExtractedAnew) {
  FusedSurface surface({.voxel_size = 0.05});
  SurfaceMesh kept({});
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(60, 60, 1.3);
  const Eigen::AlignedBox3d box(Point(1.51, -0.33, -0.27), Point(2.13, 0.41, 0.23));
  for (int k = 0; k < 6; ++k) {
    const RigidTransform T_WC =
        test::LookingAlong(Point(0.1 * k, 0.2 * k - 0.5, 0.05 * k), 0.05 * k, 0.02 * k);
    const PointCloud cloud = test::CloudOf(camera, T_WC, [&](const Point& o, const Point& d) {
      return std::min(test::ToBox(box, o, d),
                      test::ToPlane(Point(3.03, 0, 0), Point(-1, 0.2, 0.1).normalized(), o, d));
    });
    kept.Update(surface.volume(), surface.Fuse(cloud, camera, T_WC));
    SurfaceMesh whole({});
    whole.Update(surface.volume(), AllBlocks(surface.volume()));
    const TriangleMesh a = kept.Joined();
    const TriangleMesh b = whole.Joined();
    ASSERT_EQ(a.vertices_W, b.vertices_W);
    EXPECT_EQ(a.faces, b.faces);
    EXPECT_EQ(a.colors, b.colors);
    EXPECT_EQ(a.normals_W, b.normals_W);
    EXPECT_NEAR(kept.area().seen, test::AreaOf(a), 1e-3);
    EXPECT_NEAR(kept.area().seen, whole.area().seen, 1e-6);
    EXPECT_NEAR(kept.area().inspected, whole.area().inspected, 1e-6);
  }
}

TEST(SurfaceMesh, EndsWhereNothingWasSeen) {
  TruncatedVolume volume = VolumeOf(0.1, [](int, int, int z) { return 0.1 * (z - 2.3); });
  for (int z = 0; z < 8; ++z) {
    for (int y = 0; y < 8; ++y) volume.At({0, 0, 0}).voxels[TruncatedVolume::OffsetOf(4, y, z)].weight = 0.0F;
  }
  SurfaceMesh mesh({});
  mesh.Update(volume, AllBlocks(volume));
  EXPECT_NEAR(test::AreaOf(mesh.Joined()), 2.3 * 2.3 - 0.2 * 0.9, 1e-4) << "two cells wide, nine long";
}

}  // namespace
}  // namespace thalweg::surface
