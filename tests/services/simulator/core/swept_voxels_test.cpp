#include "services/simulator/core/swept_voxels.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/voxel/for_each_voxel.h"

namespace thalweg::simulator {
namespace {

using Point = Eigen::Vector3d;
constexpr double kEdge = 0.1;

/// A leaf of 1 x 0.06 x 0.5 m that turns by 90 degrees about a hinge and then slides up by 0.4 m.
MovingPart TurningDoor() {
  const double open = std::numbers::pi / 2.0;
  return {.at_rest_W = {Point(0.02, 0.02, 0.03), Point(1.02, 0.08, 0.53)},
          .pivot_W = Point(0.02, 0.02, 0),
          .places = {{.time = 0},
                     {.time = 2, .yaw = open},
                     {.time = 3, .yaw = open, .offset_W = Point(0, 0, 0.4)}},
          .period = 0.0};
}

TEST(SweptVoxels, AreThoseThatThePartMeetsAtAnyTime) {
  const MovingPart door = TurningDoor();
  const VoxelBox box{{-5, -5, -5}, {15, 15, 15}};
  const DenseGrid<std::uint8_t> swept = SweptVoxels(std::vector{door}, box, kEdge);
  // Points of the part, densely: all of their voxels are swept.
  DenseGrid<std::uint8_t> met(box, 0);
  for (double time = 0.0; time <= 3.0; time += 0.01) {
    const RigidTransform T_WP = PoseAt(door, time);
    const Point size = door.at_rest_W.sizes();
    for (double a = 0.0; a <= 1.0; a += 0.05) {
      for (double b = 0.0; b <= 1.0; b += 0.25) {
        for (double c = 0.0; c <= 1.0; c += 0.1) {
          const Point p_W = T_WP * (door.at_rest_W.min() + size.cwiseProduct(Point(a, b, c)));
          met[VoxelAt(p_W, kEdge)] = 1;
        }
      }
    }
  }
  ForEachVoxel(box, [&](const VoxelIndex& voxel) {
    EXPECT_TRUE(swept[voxel] || !met[voxel]) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
    // None that is farther than the voxel's half diagonal and the tolerance.
    double nearest = 1e9;
    if (!swept[voxel] || met[voxel]) return;
    VisitPoses(door, 0.01, [&](const RigidTransform& T_WP) {
      nearest =
          std::min(nearest, door.at_rest_W.exteriorDistance(T_WP.inverse() * VoxelCenter(voxel, kEdge)));
    });
    EXPECT_LT(nearest, 0.5 * std::sqrt(3.0) * kEdge + 2.0 * kEdge / 8.0);
  });
}

TEST(SweptVoxels, APartThatStandsSweepsWhatItFills) {
  MovingPart part{.at_rest_W = {Point(0.12, 0.12, 0.12), Point(0.28, 0.28, 0.28)}, .places = {{.time = 0}}};
  const VoxelBox box{{-5, -5, -5}, {15, 15, 15}};
  const auto count = [&] {
    const DenseGrid<std::uint8_t> swept = SweptVoxels(std::vector{part}, box, kEdge);
    return std::count(swept.data(), swept.data() + swept.size(), 1);
  };
  EXPECT_EQ(count(), 2 * 2 * 2) << "voxels 1 and 2 on each axis";
  part.at_rest_W = {Point(5, 5, 5), Point(6, 6, 6)};
  EXPECT_EQ(count(), 0) << "beyond the box";
}

}  // namespace
}  // namespace thalweg::simulator
