#include "services/evaluator/core/noise_free_map.h"

#include <gtest/gtest.h>

#include "common/voxel/voxels_within.h"
#include "services/mapper/core/occupancy_map.h"
#include "tests/support/meshes.h"

namespace thalweg::evaluator {
namespace {

const Eigen::AlignedBox3d kRoom{Eigen::Vector3d(-1.53, -1.53, -1.53), Eigen::Vector3d(1.47, 1.47, 1.47)};

RigidTransform Looking(double yaw) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0) * BodyFromOptical(),
                       Eigen::Vector3d(-0.03, -0.03, -0.03));
}

/// The map of two scans by a sensor with that noise, beside the one without.
struct Pair {
  explicit Pair(const DepthSensorModel& sensor)
      : noise_free(world, sensor, nullptr,
                   std::make_unique<mapper::OccupancyMap>(mapper::OccupancyMap::Options{})) {
    mapper::OccupancyMap map({});
    simulator::DepthSensor noisy(sensor);
    for (const double yaw : {0.0, 1.0}) {
      noise_free.OnScan(Looking(yaw));
      map.Integrate(noisy.Capture(world, Looking(yaw)), Looking(yaw));
    }
    known = map.Snapshot();
  }

  simulator::World world{test::BoxMesh(kRoom.min(), kRoom.max()), kRoom};
  NoiseFreeMap noise_free;
  OccupancyGrid known{mapper::OccupancyMap::Options{}.voxel_size};
};

TEST(NoiseFreeMap, IsTheMapOfASensorWithoutNoise) {
  EXPECT_EQ(Pair({}).noise_free.Likeness(Pair({}).known), 1.0);
}

TEST(NoiseFreeMap, CountsEachVoxelOfTheBoxWhoseStateDiffersAndNoOther) {
  Pair pair({});
  const VoxelBox box = VoxelsWithin(kRoom, pair.known.voxel_size());
  const auto all = static_cast<double>(box.count());
  const VoxelIndex free = pair.known.IndexOf({0.5, 0.0, 0.0});
  const VoxelIndex unknown = pair.known.IndexOf({-1.0, 0.0, 0.0});
  ASSERT_EQ(pair.known.State(free), VoxelState::kFree);
  ASSERT_EQ(pair.known.State(unknown), VoxelState::kUnknown);

  pair.known.Set({box.max.x + 3, 0, 0}, 1.0F);
  EXPECT_EQ(pair.noise_free.Likeness(pair.known), 1.0) << "outside of the box";
  pair.known.Set(unknown, 1.0F);
  EXPECT_DOUBLE_EQ(pair.noise_free.Likeness(pair.known), 1.0 - 1.0 / all) << "known here only";
  pair.known.Set(free, 1.0F);
  EXPECT_DOUBLE_EQ(pair.noise_free.Likeness(pair.known), 1.0 - 2.0 / all) << "occupied here only";
  pair.known.Set(free, OccupancyGrid::kUnknown);
  EXPECT_DOUBLE_EQ(pair.noise_free.Likeness(pair.known), 1.0 - 2.0 / all) << "known there only";
}

TEST(NoiseFreeMap, LeavesOutBothNoises) {
  const DepthSensorModel along{.disparity_noise_px = 1.0};
  const DepthSensorModel in_image{.image_noise_px = 1.0};
  const OccupancyGrid exact = Pair({}).known;
  for (const DepthSensorModel& sensor : {along, in_image}) {
    const Pair pair(sensor);
    EXPECT_EQ(pair.noise_free.Likeness(exact), 1.0);
    EXPECT_LT(pair.noise_free.Likeness(pair.known), 0.99);
  }
}

}  // namespace
}  // namespace thalweg::evaluator
