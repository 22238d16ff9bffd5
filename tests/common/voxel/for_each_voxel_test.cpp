#include "common/voxel/for_each_voxel.h"

#include <gtest/gtest.h>

#include <vector>

namespace thalweg {
namespace {

TEST(ForEachVoxel, VisitsEachVoxelOnceInTheOrderOfADenseGrid) {
  const VoxelBox box{{-2, 3, -1}, {1, 5, 3}};
  const DenseGrid<int> grid(box, 0);
  std::vector<VoxelIndex> visited;
  EXPECT_TRUE(ForEachVoxel(box, [&](const VoxelIndex& i) { visited.push_back(i); }));
  ASSERT_EQ(visited.size(), box.count());
  for (std::size_t k = 0; k < visited.size(); ++k) EXPECT_EQ(visited[k], grid.IndexAt(k));
}

TEST(ForEachVoxel, AnEmptyBoxHasNone) {
  for (const VoxelBox& box : {VoxelBox{{0, 0, 0}, {0, 4, 4}}, VoxelBox{{3, 0, 0}, {1, 4, 4}}}) {
    EXPECT_TRUE(ForEachVoxel(box, [](const VoxelIndex&) { ADD_FAILURE(); }));
  }
}

TEST(ForEachVoxel, StopsWhereTheVisitorSaysSo) {
  int visited = 0;
  EXPECT_FALSE(ForEachVoxel({{0, 0, 0}, {9, 9, 9}}, [&](const VoxelIndex& i) {
    ++visited;
    return !(i == VoxelIndex{1, 1, 0});
  }));
  EXPECT_EQ(visited, 11);
}

TEST(CubeAround, HasTheCenterInItsMiddle) {
  EXPECT_EQ(CubeAround({5, -5, 0}, 1), (VoxelBox{{4, -6, -1}, {7, -3, 2}}));
  EXPECT_EQ(CubeAround({5, -5, 0}, 0).count(), 1U);
}

TEST(Intersection, HoldsWhatIsInBoth) {
  const VoxelBox a{{0, 0, 0}, {4, 4, 4}};
  const VoxelBox b{{2, -3, 1}, {9, 2, 9}};
  const VoxelBox both = Intersection(a, b);
  ForEachVoxel({{-4, -4, -4}, {10, 10, 10}},
               [&](const VoxelIndex& i) { EXPECT_EQ(both.Contains(i), a.Contains(i) && b.Contains(i)); });
  EXPECT_EQ(Intersection(a, {{4, 0, 0}, {6, 4, 4}}).count(), 0U);
}

}  // namespace
}  // namespace thalweg
