#include <gtest/gtest.h>

#include <cmath>
#include <unordered_set>

#include "services/mapper/core/map_engine.h"
#include "tests/services/mapper/core/small_clouds.h"
#include "tests/services/mapper/support/each_engine.h"
#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::kInfinity;
using test::kNaN;

constexpr double kRange = 2.0;  // [m]
/// Coarse, so that no two rays end in the same voxel at that range: only one ray per voxel is cast.
const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(10, 8, 1.3);
const RigidTransform kSomewhere =
    MakeTransform(RotationFromYawPitch(0.4, -0.2) * BodyFromOptical(), {0.031, -0.044, 0.052});

OccupancyMap::Options WithNoReturn() {
  OccupancyMap::Options options;
  options.max_range = kRange;
  options.no_return = kCamera;
  return options;
}

class NoReturnOfEachEngine : public testing::TestWithParam<MapEngine> {};
INSTANTIATE_TEST_SUITE_P(Engines, NoReturnOfEachEngine, test::kEngines, test::NameOfEngine);

PointCloud Filled(const Eigen::Vector3f& p_C) {
  const auto pixels = static_cast<std::size_t>(kCamera.width_px * kCamera.height_px);
  return {.width_px = kCamera.width_px,
          .height_px = kCamera.height_px,
          .points_C = std::vector<Eigen::Vector3f>(pixels, p_C),
          .colors = {}};
}

TEST_P(NoReturnOfEachEngine, ClearsWhatARayWithASurfaceBeyondRangeClears) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  for (const bool rules : {true, false}) {
    for (const double sigma : {0.0, 0.01}) {
      OccupancyMap::Options options = WithNoReturn();
      options.protect = options.fill = rules;
      options.shadow = rules ? 3.0 : 0.0;
      options.depth_error.sigma = sigma;
      const auto map = MakeMap(GetParam(), options);
      options.no_return.reset();
      const auto peer = MakeMap(GetParam(), options);
      std::mt19937 random(3);
      std::size_t open = 0;
      for (int scan = 0; scan < 30; ++scan) {
        const RigidTransform T_WC = room.RandomPose(random);
        PointCloud with_no_return = room.Render(kCamera, T_WC, kRange);
        PointCloud far = with_no_return;
        for (int v = 0, k = 0; v < kCamera.height_px; ++v) {
          for (int u = 0; u < kCamera.width_px; ++u, ++k) {
            const auto pixel = static_cast<std::size_t>(k);
            if (!std::isnan(with_no_return.points_C[pixel].x())) continue;
            ++open;
            with_no_return.points_C[pixel] = NoReturn();
            far.points_C[pixel] = (3.0 * kRange * kCamera.RayAtUnitDepth(u, v).normalized()).cast<float>();
          }
        }
        map->Integrate(with_no_return, T_WC);
        if (sigma == 0.0) peer->Integrate(far, T_WC);
      }
      EXPECT_GT(open, 200U);
      if (sigma == 0.0) {
        EXPECT_TRUE(map->Snapshot().SameAs(peer->Snapshot())) << rules;
      } else {
        // a measured far point would be smoothed and would clear less, so that only the set of free voxels
        // can be compared
        std::size_t free = 0;
        map->Snapshot().ForEachKnown(
            [&](const VoxelIndex&, float log_odds) { free += log_odds < 0.0F ? 1 : 0; });
        EXPECT_GT(free, 5000U) << rules;
      }
    }
  }
}

TEST_P(NoReturnOfEachEngine, ClearsTheVoxelsThatItsRaysCrossWithinRangeAndNoOthers) {
  const auto map = MakeMap(GetParam(), WithNoReturn());
  map->Integrate(Filled(NoReturn()), kSomewhere);
  const OccupancyGrid grid = map->Snapshot();
  const auto voxel_of = [&](const Eigen::Vector3d& p_W) { return grid.IndexOf(p_W); };
  std::unordered_set<VoxelIndex, VoxelIndexHash> may_be;
  std::size_t missing = 0;
  std::size_t crossed_voxels = 0;
  for (int v = 0; v < kCamera.height_px; ++v) {
    for (int u = 0; u < kCamera.width_px; ++u) {
      const Eigen::Vector3d ray_W = kSomewhere.linear() * kCamera.RayAtUnitDepth(u, v).normalized();
      const auto at = [&](double range) { return Eigen::Vector3d(kSomewhere.translation() + range * ray_W); };
      constexpr double kStep = 5e-4;  // [m]
      int in_a_row = 0;
      for (double range = 0.0; range < kRange; range += kStep) {
        for (const double off : {-1e-3, 0.0, 1e-3}) {
          for (int axis = 0; axis < 3; ++axis)
            may_be.insert(voxel_of(at(range) + off * Eigen::Vector3d::Unit(axis)));
        }
        const VoxelIndex voxel = voxel_of(at(range));
        in_a_row = voxel == voxel_of(at(range + kStep)) ? in_a_row + 1 : 0;
        // Voxels that are only clipped at an edge, and the voxel in which the ray ends, depend on rounding.
        if (in_a_row != 4 || voxel == voxel_of(at(kRange))) continue;
        ++crossed_voxels;
        missing += grid.State(voxel) == VoxelState::kFree ? 0 : 1;
      }
    }
  }
  EXPECT_GT(crossed_voxels, 1500U);
  EXPECT_EQ(missing, 0U);
  grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    EXPECT_LT(log_odds, 0.0F) << "nothing is hit";
    EXPECT_TRUE(may_be.contains(voxel)) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
  });
}

TEST_P(NoReturnOfEachEngine, IsNoMeasurementFromASensorThatDoesNotSaySo) {
  OccupancyMap::Options options = WithNoReturn();
  options.no_return.reset();
  const auto map = MakeMap(GetParam(), options);
  EXPECT_TRUE(map->Integrate(Filled(NoReturn()), kSomewhere).empty());
}

TEST_P(NoReturnOfEachEngine, IsNoMeasurementInACloudOfAnotherSizeOrNone) {
  const auto map = MakeMap(GetParam(), WithNoReturn());
  for (const auto& [width, height] : {std::pair{8, 10}, {80, 1}, {10, 9}, {0, 0}}) {
    PointCloud cloud = Filled(NoReturn());
    cloud.width_px = width;
    cloud.height_px = height;
    EXPECT_TRUE(map->Integrate(cloud, kSomewhere).empty()) << width << " x " << height;
  }
}

TEST_P(NoReturnOfEachEngine, OtherValuesThatAreNotFiniteClearNothing) {
  const auto map = MakeMap(GetParam(), WithNoReturn());
  for (const Eigen::Vector3f& p_C :
       {Eigen::Vector3f(kNaN, kNaN, kNaN), Eigen::Vector3f(0.0F, 0.0F, -kInfinity),
        Eigen::Vector3f(kInfinity, 0.0F, 1.0F), Eigen::Vector3f(0.0F, kInfinity, kNaN),
        Eigen::Vector3f(0.0F, 0.0F, 1e30F), Eigen::Vector3f(0.0F, 0.0F, 0.0F)}) {
    EXPECT_TRUE(map->Integrate(Filled(p_C), kSomewhere).empty()) << p_C.transpose();
  }
}

TEST_P(NoReturnOfEachEngine, FromAPlaceBeyondTheGridChangesNothing) {
  const auto map = MakeMap(GetParam(), WithNoReturn());
  for (const double x : {1e5, -1e300, static_cast<double>(kNaN)}) {
    EXPECT_TRUE(map->Integrate(Filled(NoReturn()), MakeTransform(BodyFromOptical(), {x, 0, 0})).empty());
  }
}

}  // namespace
}  // namespace thalweg::mapper
