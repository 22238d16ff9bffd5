#include "services/explorer/core/gaps/shadows.h"

#include <vector>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"

namespace thalweg::explorer {
namespace {

constexpr int kNotYet = -2;  ///< Hidden, but not known yet in which shadow.

bool IsCellInSight(const DenseGrid<PlaneCell>& plane, const VoxelIndex& robot, const VoxelIndex& cell) {
  return TraverseVoxels(VoxelCenter(robot, 1.0), VoxelCenter(cell, 1.0), 1.0, [&](const VoxelIndex& i) {
    return i == robot || i == cell || plane.Get(i, PlaneCell::kWall) == PlaneCell::kFree;
  });
}

/// Gives the number to all hidden cells connected with that one. @return These cells.
std::vector<VoxelIndex> Fill(const DenseGrid<PlaneCell>& plane, const VoxelIndex& first, int number,
                             DenseGrid<int>& shadows) {
  std::vector<VoxelIndex> filled = {first};
  shadows[first] = number;
  for (std::size_t n = 0; n < filled.size(); ++n) {
    const VoxelIndex at = filled[n];
    ForEachVoxel({{at.x - 1, at.y - 1, 0}, {at.x + 2, at.y + 2, 1}}, [&](const VoxelIndex& i) {
      if (shadows.Get(i, kNoShadow) != kNotYet) return;
      const bool by_edge = i.x == at.x || i.y == at.y;
      if (!by_edge && (plane[i] == PlaneCell::kFree || plane[at] == PlaneCell::kFree)) return;
      shadows[i] = number;
      filled.push_back(i);
    });
  }
  return filled;
}

}  // namespace

DenseGrid<int> FindShadows(const DenseGrid<PlaneCell>& plane, const VoxelIndex& robot, std::size_t least) {
  DenseGrid<int> shadows(plane.box(), kNoShadow);
  for (std::size_t k = 0; k < plane.size(); ++k) {
    if (plane[k] != PlaneCell::kWall && !IsCellInSight(plane, robot, plane.IndexAt(k))) shadows[k] = kNotYet;
  }
  int count = 0;
  for (std::size_t k = 0; k < plane.size(); ++k) {
    if (shadows[k] != kNotYet) continue;
    const std::vector<VoxelIndex> filled = Fill(plane, plane.IndexAt(k), count, shadows);
    bool matters = filled.size() >= least;
    for (const VoxelIndex& i : filled) matters = matters || plane[i] == PlaneCell::kUnseen;
    if (matters) {
      ++count;
    } else {
      for (const VoxelIndex& i : filled) shadows[i] = kNoShadow;
    }
  }
  return shadows;
}

}  // namespace thalweg::explorer
