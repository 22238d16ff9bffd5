#pragma once

#include "common/voxel/for_each_voxel.h"

namespace thalweg {

/// A grid over another box, with the values of the old one wherever the boxes overlap and `fresh` elsewhere.
template <class T>
DenseGrid<T> MovedTo(const DenseGrid<T>& old, const VoxelBox& box, const T& fresh) {
  DenseGrid<T> grid(box, fresh);
  ForEachVoxel(Intersection(old.box(), box), [&](const VoxelIndex& i) { grid[i] = old[i]; });
  return grid;
}

}  // namespace thalweg
