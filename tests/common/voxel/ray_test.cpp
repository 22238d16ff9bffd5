#include "common/voxel/ray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <unordered_set>
#include <vector>

namespace thalweg {
namespace {

using VoxelSet = std::unordered_set<VoxelIndex, VoxelIndexHash>;

std::vector<VoxelIndex> Traverse(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double voxel_size) {
  std::vector<VoxelIndex> voxels;
  EXPECT_TRUE(TraverseVoxels(from, to, voxel_size, [&](const VoxelIndex& i) {
    voxels.push_back(i);
    return true;
  }));
  return voxels;
}

/// Length of the segment's parameter interval within [0, 1] that lies inside the voxel, grown by `margin` [m]
/// on all sides (slab method); < 0 if they do not meet.
double ShareInside(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const VoxelIndex& i,
                   double voxel_size, double margin) {
  double enter = 0.0;
  double leave = 1.0;
  const std::int32_t index[3] = {i.x, i.y, i.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = index[axis] * voxel_size - margin;
    const double high = (index[axis] + 1) * voxel_size + margin;
    const double length = to[axis] - from[axis];
    if (std::abs(length) < 1e-15) {
      if (from[axis] < low || from[axis] > high) return -1.0;
      continue;
    }
    const double a = (low - from[axis]) / length;
    const double b = (high - from[axis]) / length;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return leave - enter;
}

/// Expects that each voxel visited touches the segment, that consecutive voxels share a face, and that no
/// voxel found by dense sampling is missing.
void ExpectEqualsDenseSampling(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double voxel_size) {
  const std::vector<VoxelIndex> voxels = Traverse(from, to, voxel_size);
  SCOPED_TRACE(testing::Message() << "from " << from.transpose() << " to " << to.transpose());
  ASSERT_EQ(voxels.front(), VoxelAt(from, voxel_size));
  ASSERT_EQ(voxels.back(), VoxelAt(to, voxel_size));
  for (std::size_t k = 1; k < voxels.size(); ++k) {
    const VoxelIndex step = voxels[k] - voxels[k - 1];
    ASSERT_EQ(std::abs(step.x) + std::abs(step.y) + std::abs(step.z), 1);
  }
  for (const VoxelIndex& i : voxels) ASSERT_GE(ShareInside(from, to, i, voxel_size, 1e-9), 0.0);

  const VoxelSet named(voxels.begin(), voxels.end());
  ASSERT_EQ(named.size(), voxels.size()) << "a voxel was named twice";
  constexpr int kSamples = 3000;
  for (int k = 0; k <= kSamples; ++k) {
    const VoxelIndex i = VoxelAt(from + (to - from) * (k / double{kSamples}), voxel_size);
    // A voxel that is merely grazed, within rounding, may be visited or not.
    const bool grazed = ShareInside(from, to, i, voxel_size, -1e-9) <= 0.0;
    ASSERT_TRUE(grazed || named.contains(i));
  }
}

TEST(VoxelRay, EqualsDenseSamplingOnRandomSegments) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  const auto point = [&] {
    return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random));
  };
  for (int k = 0; k < 300; ++k) ExpectEqualsDenseSampling(point(), point(), 0.1);
}

TEST(VoxelRay, EqualsDenseSamplingAlongAxes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d from(coordinate(random), coordinate(random), coordinate(random));
    Eigen::Vector3d to = from;
    to[k % 3] = coordinate(random);
    ExpectEqualsDenseSampling(from, to, 0.1);
  }
}

TEST(VoxelRay, EqualsDenseSamplingThroughCornersAndEdges) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> corner(-20, 20);
  const auto point = [&]() -> Eigen::Vector3d {
    return 0.125 * Eigen::Vector3d(corner(random), corner(random), corner(random));
  };
  for (int k = 0; k < 300; ++k) ExpectEqualsDenseSampling(point(), point(), 0.125);
  ExpectEqualsDenseSampling({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, 0.125);
  ExpectEqualsDenseSampling({1.0, 1.0, 1.0}, {-1.0, -1.0, -1.0}, 0.125);
  ExpectEqualsDenseSampling({0.0625, 0.0625, 0.0}, {0.9375, 0.9375, 0.0}, 0.125);
}

TEST(VoxelRay, OfOnePointIsItsVoxel) {
  const Eigen::Vector3d point(0.31, -0.02, 7.77);
  EXPECT_EQ(Traverse(point, point, 0.1), std::vector<VoxelIndex>{VoxelAt(point, 0.1)});
}

TEST(VoxelRay, StopsWhereTheVisitorSaysSo) {
  int visited = 0;
  EXPECT_FALSE(TraverseVoxels({0.05, 0.05, 0.05}, {0.95, 0.05, 0.05}, 0.1,
                              [&](const VoxelIndex& i) { return ++visited, i.x < 4; }));
  EXPECT_EQ(visited, 5);
}

}  // namespace
}  // namespace thalweg
