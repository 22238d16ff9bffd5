#include "services/surface/core/fused/mesh_rifts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/services/surface/core/fused/clouds.h"
#include "tests/services/surface/core/fused/volumes.h"

namespace thalweg::surface {
namespace {

constexpr double kRiftVoxel = 0.1;

/// A box from -0.57 to 1.37 m along each axis, solid inside.
double DistanceToSolid(int x, int y, int z) {
  const auto beyond = [](int i) { return std::abs(kRiftVoxel * (i + 0.5) - 0.4) - 0.97; };
  return std::max({beyond(x), beyond(y), beyond(z)});
}
/// A sphere of radius 0.97 m around (0.4, 0.4, 0.4).
double DistanceToBall(int x, int y, int z) {
  const auto from = [](int i) { return kRiftVoxel * (i + 0.5) - 0.4; };
  return std::hypot(from(x), from(y), from(z)) - 0.97;
}

/// A volume, its mesh and their rifts.
class TornSurface {
 public:
  template <class DistanceOf>
  explicit TornSurface(DistanceOf&& distance_of, double sigma = 0.0)
      : volume_(test::VolumeOf(kRiftVoxel, distance_of)), rifts_(kRiftVoxel, {.sigma = sigma}) {
    Follow();
  }
  void Follow() { rifts_.Update(mesh_, mesh_.Update(volume_, test::AllBlocks(volume_))); }
  /// A hole in the box's top, which is between the voxels 12 and 13, or fills it.
  void Tear(int left, int right, int front, int back, bool known = false) {
    test::SetKnown(volume_, {left, front, 11}, {right, back, 14}, known);
    Follow();
  }
  void Fill() { Tear(-8, 15, -8, 15, true); }
  const std::vector<MeshRift>& Find(const std::optional<Eigen::Vector3d>& looked_at_W = {}) {
    rifts_.Find(mesh_, looked_at_W);
    return rifts_.open();
  }
  const std::deque<MeshRift>& ended() const { return rifts_.ended(); }
  TruncatedVolume& volume() { return volume_; }

 private:
  TruncatedVolume volume_;
  SurfaceMesh mesh_{InspectionLimits{}};
  MeshRifts rifts_;
};

std::vector<std::uint32_t> NumbersOf(const std::vector<MeshRift>& rifts) {
  std::vector<std::uint32_t> numbers;
  for (const MeshRift& rift : rifts) numbers.push_back(rift.number);
  return numbers;
}

TEST(MeshRifts, ThereIsNoneInAClosedSurface) {
  EXPECT_TRUE(TornSurface(DistanceToSolid).Find().empty());
  EXPECT_TRUE(TornSurface(DistanceToBall).Find().empty());
}

TEST(MeshRifts, AHoleIsOneOfItsPerimeterCenterAndNormal) {
  TornSurface box(DistanceToSolid);
  box.Tear(1, 6, 2, 5);  // from the centers of voxels 0 and 1 to those of 7 and 6
  const auto rifts = box.Find();
  ASSERT_EQ(rifts.size(), 1U);
  EXPECT_NEAR(rifts[0].length, 2.0 * (0.7 + 0.5), 1e-5);
  EXPECT_EQ(rifts[0].edges, 24U) << "as many as cells around it";
  EXPECT_LT((rifts[0].center_W.cast<double>() - Eigen::Vector3d(0.4, 0.4, 1.37)).norm(), 1e-5);
  EXPECT_LT((rifts[0].normal_W - Eigen::Vector3f::UnitZ()).norm(), 1e-4F);
  EXPECT_EQ(rifts[0].line_W.size(), 24U);
  EXPECT_EQ(rifts[0].number, 1U);
  EXPECT_EQ(rifts[0].fate, MeshRift::Fate::kOpen);
}

TEST(MeshRifts, OneThatLiesInFourBlocksIsOne) {
  TornSurface box(DistanceToSolid);
  box.Tear(4, 10, 5, 11);
  const auto rifts = box.Find();
  ASSERT_EQ(rifts.size(), 1U);
  EXPECT_NEAR(rifts[0].length, 4.0 * 0.8, 1e-5);
  EXPECT_LT((rifts[0].center_W.cast<double>() - Eigen::Vector3d(0.75, 0.85, 1.37)).norm(), 1e-5);
}

TEST(MeshRifts, TwoHolesAreTwoAndTheirNormalsFaceTheirSides) {
  TornSurface box(DistanceToSolid);
  box.Tear(1, 6, 1, 6);
  test::SetKnown(box.volume(), {-7, 1, 1}, {-4, 6, 5}, false);  // the side, between the voxels -7 and -6
  box.Follow();
  const auto rifts = box.Find();
  ASSERT_EQ(rifts.size(), 2U);
  EXPECT_NEAR(rifts[0].length, 2.8, 1e-5) << "without a path, longest first";
  EXPECT_NEAR(rifts[1].length, 2.6, 1e-5);
  EXPECT_LT((rifts[0].normal_W - Eigen::Vector3f::UnitZ()).norm(), 1e-4F);
  EXPECT_LT((rifts[1].normal_W + Eigen::Vector3f::UnitX()).norm(), 1e-4F);
}

TEST(MeshRifts, OneMustBeLongerThanWhatIsUncertainFromVoxelSpacingAndError) {
  // 8 (rho + v), rho^2 = v^2 + s^2 + 12 (sigma z^2)^2: of a hole that many voxels wide.
  const auto finds = [](int width, double spacing, double distance, double sigma) {
    TornSurface box(DistanceToSolid, sigma);
    for (int z = -8; z <= 15; ++z) {
      for (int y = -8; y <= 15; ++y) {
        for (int x = -8; x <= 15; ++x) {
          test::VoxelOf(box.volume(), x, y, z)
              .best.Improve({.distance = static_cast<float>(distance),
                             .cosine = 1.0F,
                             .sampling = static_cast<float>(spacing)},
                            false);
        }
      }
    }
    box.Tear(0, width - 2, 0, width - 2);
    return !box.Find().empty();
  };
  EXPECT_FALSE(finds(3, 0.0, 1.0, 0.0));
  EXPECT_TRUE(finds(5, 0.0, 1.0, 0.0)) << "2 (1 + 1) voxels";
  EXPECT_FALSE(finds(6, 0.2, 1.0, 0.0));
  EXPECT_TRUE(finds(7, 0.2, 1.0, 0.0)) << "2 (sqrt(1 + 4) + 1)";
  EXPECT_FALSE(finds(6, 0.0, 2.0, 0.0145));
  EXPECT_TRUE(finds(7, 0.0, 2.0, 0.0145)) << "2 (sqrt(1 + 12 0.58^2) + 1)";
  EXPECT_TRUE(finds(5, 0.0, 0.5, 0.0145)) << "seen from nearer";
}

TEST(MeshRifts, WeightIsHalfTheDistanceOverTheSurfaceAndHalfTheEdges) {
  TornSurface box(DistanceToSolid);
  box.Tear(1, 6, 1, 6);
  // From the middle of the side at x = -0.57 m: up the side, then over the top to the hole, and to its
  // center.
  const MeshRift rift = box.Find(Eigen::Vector3d(-0.57, 0.4, 0.4)).at(0);
  EXPECT_NEAR(rift.distance, 0.97 + 0.97, 0.8) << "to a block";
  EXPECT_GT(rift.distance, std::hypot(0.97, 0.97)) << "not through the box";
  EXPECT_EQ(rift.weight, 0.5 * rift.distance + 0.5 * rift.edges);
  EXPECT_NEAR(rift.nearest_W.x(), 0.05, 1e-5) << "it is reached from this side";
}

TEST(MeshRifts, WithoutAPathNoDistanceIsKnown) {
  const auto two = [](int, int, int z) { return kRiftVoxel * std::max(-3.0 - z, z - 9.0); };
  TornSurface sheets(two);
  const auto rifts = sheets.Find(Eigen::Vector3d(0.4, 0.4, 0.95));
  ASSERT_EQ(rifts.size(), 2U);
  EXPECT_NEAR(rifts[0].center_W.z(), 0.95, 1e-5);
  EXPECT_NEAR(rifts[0].distance, 2.3, 0.8) << "to the rim, and back to the middle";
  EXPECT_NEAR(rifts[0].length, 4.0 * 2.3, 1e-4);
  EXPECT_EQ(rifts[1].distance, MeshRift::kNoPath);
  EXPECT_EQ(rifts[1].weight, 0.0);
  EXPECT_NEAR(rifts[1].nearest_W.z(), -0.25, 1e-5);
  for (const MeshRift& rift : sheets.Find()) EXPECT_EQ(rift.distance, MeshRift::kNoPath);
  for (const MeshRift& rift : sheets.Find(Eigen::Vector3d(50.0, 0.0, 0.0)))
    EXPECT_EQ(rift.distance, MeshRift::kNoPath);
}

TEST(MeshRifts, KeepsItsNumberWhileItShrinksUntilItCloses) {
  TornSurface box(DistanceToSolid);
  box.Tear(-4, 11, -4, 11);
  ASSERT_THAT(NumbersOf(box.Find()), testing::ElementsAre(1U));
  for (int by = 2; by <= 4; by += 2) {
    box.Fill();
    box.Tear(-4 + by, 11 - by, -4 + by, 11 - by);
    const auto rifts = box.Find();
    ASSERT_THAT(NumbersOf(rifts), testing::ElementsAre(1U));
    EXPECT_NEAR(rifts[0].length, 4.0 * (1.7 - 0.2 * by), 1e-5);
  }
  EXPECT_TRUE(box.ended().empty());
  box.Fill();
  EXPECT_TRUE(box.Find().empty());
  ASSERT_EQ(box.ended().size(), 1U);
  EXPECT_EQ(box.ended()[0].number, 1U);
  EXPECT_EQ(box.ended()[0].fate, MeshRift::Fate::kClosed);
  EXPECT_EQ(box.ended()[0].merged_into, 0U);
  EXPECT_NEAR(box.ended()[0].length, 3.6, 1e-5) << "what was last known";
  box.Tear(-4, 11, -4, 11);
  EXPECT_THAT(NumbersOf(box.Find()), testing::ElementsAre(2U)) << "another one";
}

TEST(MeshRifts, ThoseThatGrowTogetherAreTheLargerOne) {
  TornSurface box(DistanceToSolid);
  box.Tear(-4, -1, 0, 5);
  box.Find();
  box.Tear(3, 12, 0, 5);
  ASSERT_THAT(NumbersOf(box.Find()), testing::ElementsAre(2U, 1U)) << "longest first";
  box.Tear(-1, 3, 2, 3);
  ASSERT_THAT(NumbersOf(box.Find()), testing::ElementsAre(2U));
  ASSERT_EQ(box.ended().size(), 1U);
  EXPECT_EQ(box.ended()[0].number, 1U);
  EXPECT_EQ(box.ended()[0].fate, MeshRift::Fate::kMerged);
  EXPECT_EQ(box.ended()[0].merged_into, 2U);
}

TEST(MeshRifts, TheLargestPartOfOneThatSplitsGoesOn) {
  TornSurface box(DistanceToSolid);
  box.Tear(-4, 11, 0, 5);
  box.Find();
  box.Tear(0, 2, 0, 5, true);
  ASSERT_THAT(NumbersOf(box.Find()), testing::ElementsAre(1U, 2U));
  EXPECT_TRUE(box.ended().empty());
}

TEST(MeshRifts, OnlyTheLastThatEndedAreKept) {
  TornSurface box(DistanceToSolid);
  for (std::size_t k = 0; k < MeshRifts::kMostEnded + 3; ++k) {
    box.Tear(0, 5, 0, 5);
    box.Find();
    box.Fill();
    box.Find();
  }
  ASSERT_EQ(box.ended().size(), MeshRifts::kMostEnded);
  EXPECT_EQ(box.ended().front().number, MeshRifts::kMostEnded + 3);
  EXPECT_EQ(box.ended().back().number, 4U);
}

TEST(MeshRifts, KeptUpToDateAreThoseOfAllAtOnce) {
  FusedSurface surface({.voxel_size = 0.05});
  SurfaceMesh mesh({});
  MeshRifts kept(0.05, {});
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(60, 60, 1.3);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(1.51, -0.33, -0.27), Eigen::Vector3d(2.13, 0.41, 0.23));
  std::size_t most = 0;
  for (int k = 0; k < 8; ++k) {
    const RigidTransform T_WC = test::LookingAlong({0.1 * k, 0.3 * k - 1.0, 0.05 * k}, 0.05 * k, 0.02 * k);
    const PointCloud cloud =
        test::CloudOf(camera, T_WC, [&](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
          return std::min(test::ToBox(box, o, d),
                          test::ToPlane({3.03, 0, 0}, Eigen::Vector3d(-1, 0.2, 0.1).normalized(), o, d));
        });
    kept.Update(mesh, mesh.Update(surface.volume(), surface.Fuse(cloud, camera, T_WC)));
    const Eigen::Vector3d looked_at_W = T_WC * cloud.points_C[30 * 60 + 30].cast<double>();
    kept.Find(mesh, looked_at_W);
    SurfaceMesh whole({});
    MeshRifts expected(0.05, {});
    expected.Update(whole, whole.Update(surface.volume(), test::AllBlocks(surface.volume())));
    expected.Find(whole, looked_at_W);
    const auto without_numbers = [](std::vector<MeshRift> rifts) {
      for (MeshRift& rift : rifts) rift.number = 0;
      return rifts;
    };
    ASSERT_EQ(without_numbers(kept.open()), without_numbers(expected.open()));
    most = std::max(most, kept.open().size());
  }
  EXPECT_GE(most, 2U) << "the image's edge, and behind the box";
}

}  // namespace
}  // namespace thalweg::surface
