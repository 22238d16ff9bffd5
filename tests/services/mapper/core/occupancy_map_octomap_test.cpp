#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "services/mapper/core/occupancy_map.h"
#include "tests/services/mapper/core/octomap_peer.h"
#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::OctomapPeer;

struct MapCase {
  double voxel_size;
  double max_range;
  bool lazy;
};

class OccupancyMapBesideOctomap : public testing::TestWithParam<MapCase> {
 protected:
  OccupancyMap::Options MapOptions() const {
    OccupancyMap::Options options = OccupancyMap::Options::OfOctomap();
    options.voxel_size = GetParam().voxel_size;
    options.max_range = GetParam().max_range;
    options.min_range = 0.0;
    return options;
  }
  /// Integrates each cloud into both maps and compares every voxel.
  void ExpectSame(const std::vector<std::pair<PointCloud, RigidTransform>>& scans) {
    OccupancyMap ours(MapOptions());
    OctomapPeer theirs(MapOptions());
    for (const auto& [cloud, T_WC] : scans) {
      ours.Integrate(cloud, T_WC);
      theirs.Insert(OctomapPeer::ToWorld(cloud, T_WC), T_WC, GetParam().max_range, GetParam().lazy);
      if (GetParam().lazy) theirs.updateInnerOccupancy();
    }
    EXPECT_GT(theirs.size(), 1u);
    EXPECT_EQ(theirs.Differences(ours.grid()), 0u);
  }
};

RigidTransform RandomTransform(std::mt19937& random, double extent) {
  std::uniform_real_distribution<double> position(-extent, extent);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return MakeTransform(q.normalized().toRotationMatrix(),
                       {position(random), position(random), position(random)});
}

TEST_P(OccupancyMapBesideOctomap, RandomPointsNearAndFarGiveTheSameVoxels) {
  std::mt19937 random(17);
  std::vector<std::pair<PointCloud, RigidTransform>> scans;
  for (int scan = 0; scan < 12; ++scan) {
    PointCloud cloud{.width_px = 700, .height_px = 1, .points_C = {}, .colors = {}};
    // Ranges from well inside the sensor's own voxel to several times max_range.
    std::uniform_real_distribution<float> exponent(-7.0F, 1.0F);
    std::normal_distribution<float> normal;
    for (int i = 0; i < cloud.width_px; ++i) {
      const Eigen::Vector3f direction(normal(random), normal(random), normal(random));
      const auto reach = static_cast<float>(2.0 * GetParam().max_range);
      cloud.points_C.push_back(direction.normalized() * reach * std::exp2(exponent(random)));
    }
    scans.emplace_back(std::move(cloud), RandomTransform(random, 3.0));
  }
  ExpectSame(scans);
}

TEST_P(OccupancyMapBesideOctomap, RenderedScansOfARoomGiveTheSameVoxels) {
  std::mt19937 random(23);
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const auto camera = PinholeCamera::FromFieldOfView(100, 100, 1.309);
  std::vector<std::pair<PointCloud, RigidTransform>> scans;
  for (int scan = 0; scan < 8; ++scan) {
    const RigidTransform T_WC = room.RandomPose(random);
    scans.emplace_back(room.Render(camera, T_WC), T_WC);
  }
  ExpectSame(scans);
}

// Where rays run along voxel faces, edges and diagonals, rounding alone decides.
TEST_P(OccupancyMapBesideOctomap, RaysAlongFacesAndDiagonalsGiveTheSameVoxels) {
  std::vector<std::pair<PointCloud, RigidTransform>> scans;
  const auto size = static_cast<float>(GetParam().voxel_size);
  for (const float shift : {0.0F, 0.5F, -0.25F}) {
    PointCloud cloud{.width_px = 0, .height_px = 1, .points_C = {}, .colors = {}};
    for (int x = -12; x <= 12; x += 3) {
      for (int y = -12; y <= 12; y += 3) {
        for (int z = -12; z <= 12; z += 3) {
          cloud.points_C.emplace_back(static_cast<float>(x) * size, static_cast<float>(y) * size,
                                      static_cast<float>(z) * size);
        }
      }
    }
    cloud.width_px = static_cast<int>(cloud.points_C.size());
    scans.emplace_back(std::move(cloud),
                       MakeTransform(Eigen::Matrix3d::Identity(),
                                     Eigen::Vector3d::Constant(static_cast<double>(shift * size))));
  }
  ExpectSame(scans);
}

INSTANTIATE_TEST_SUITE_P(SizesAndRanges, OccupancyMapBesideOctomap,
                         testing::Values(MapCase{0.1, 5.0, true}, MapCase{0.1, 5.0, false},
                                         MapCase{0.1, 1.3, true}, MapCase{0.05, 3.0, true},
                                         MapCase{0.07, 4.0, false}, MapCase{0.2, 20.0, true},
                                         MapCase{0.33, 2.0, false}),
                         [](const testing::TestParamInfo<MapCase>& tested) {
                           return std::to_string(static_cast<int>(tested.param.voxel_size * 100)) + "cm_" +
                                  std::to_string(static_cast<int>(tested.param.max_range * 10)) + "dm_" +
                                  (tested.param.lazy ? "lazy" : "eager");
                         });

TEST(OccupancyMap, ManyRandomScenesGiveOctomapsVoxels) {
  const auto camera = PinholeCamera::FromFieldOfView(40, 30, 1.2);
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> size(0.04, 0.4);
    std::uniform_real_distribution<double> range(0.5, 9.0);
    OccupancyMap::Options options = OccupancyMap::Options::OfOctomap();
    options.voxel_size = size(random);
    options.max_range = range(random);
    options.min_range = 0.0;
    OccupancyMap ours(options);
    OctomapPeer theirs(options);
    const AnalyticRoom room = AnalyticRoom::Furnished();
    for (int scan = 0; scan < 6; ++scan) {
      const RigidTransform T_WC = room.RandomPose(random);
      const PointCloud cloud = room.Render(camera, T_WC);
      ours.Integrate(cloud, T_WC);
      theirs.Insert(OctomapPeer::ToWorld(cloud, T_WC), T_WC, options.max_range, true);
    }
    EXPECT_EQ(theirs.Differences(ours.grid()), 0u) << "seed " << seed;
  }
}

// Where no two points share a voxel, rays to the points are those that OctoMap casts without discretization.
TEST(OccupancyMap, ExactRaysGiveTheVoxelsOfOctomapWithoutDiscretization) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> range(1.0, 6.0);
    OccupancyMap::Options options = OccupancyMap::Options::OfOctomap();
    options.max_range = range(random);
    options.min_range = 0.0;
    options.exact_rays = true;
    OccupancyMap ours(options);
    OctomapPeer theirs(options);
    for (int scan = 0; scan < 5; ++scan) {
      const RigidTransform T_WC = RandomTransform(random, 3.0);
      const Eigen::Matrix3f R_WC = T_WC.linear().cast<float>();
      const Eigen::Vector3f p_WC = T_WC.translation().cast<float>();
      PointCloud cloud{.width_px = 0, .height_px = 1, .points_C = {}, .colors = {}};
      std::set<std::array<std::int32_t, 3>> taken;
      std::uniform_real_distribution<float> coordinate(-4.0F, 4.0F);
      for (int i = 0; i < 400; ++i) {
        const Eigen::Vector3f p_C(coordinate(random), coordinate(random), coordinate(random));
        const VoxelIndex voxel = VoxelAt(ToWorld(R_WC, p_WC, p_C).cast<double>(), options.voxel_size);
        if (taken.insert({voxel.x, voxel.y, voxel.z}).second) cloud.points_C.push_back(p_C);
      }
      cloud.width_px = static_cast<int>(cloud.points_C.size());
      ours.Integrate(cloud, T_WC);
      theirs.Insert(OctomapPeer::ToWorld(cloud, T_WC), T_WC, options.max_range, /*lazy=*/true,
                    /*discretize=*/false);
    }
    EXPECT_EQ(theirs.Differences(ours.grid()), 0u) << "seed " << seed;
  }
}

}  // namespace
}  // namespace thalweg::mapper
