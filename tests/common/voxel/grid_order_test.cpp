#include "common/voxel/grid_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/voxel/dense_grid.h"

namespace thalweg {
namespace {

TEST(GridOrder, IsThatOfADenseGridsMemory) {
  const DenseGrid<int> grid({{-2, 3, 0}, {2, 5, 3}}, 0);
  std::vector<VoxelIndex> in_memory;
  for (std::size_t k = 0; k < grid.size(); ++k) in_memory.push_back(grid.IndexAt(k));
  std::vector<VoxelIndex> sorted(in_memory.rbegin(), in_memory.rend());
  std::ranges::sort(sorted, GridOrder());
  EXPECT_EQ(sorted, in_memory);
}

}  // namespace
}  // namespace thalweg
