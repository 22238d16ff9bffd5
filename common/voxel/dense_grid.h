#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/base/check.h"
#include "common/voxel/voxel_index.h"

namespace thalweg {

/// A box of voxels, from `min` inclusive to `max` exclusive.
struct VoxelBox {
  VoxelIndex min;
  VoxelIndex max;

  bool operator==(const VoxelBox&) const = default;
  int size_x() const { return std::max(0, max.x - min.x); }
  int size_y() const { return std::max(0, max.y - min.y); }
  int size_z() const { return std::max(0, max.z - min.z); }
  std::size_t count() const {
    return static_cast<std::size_t>(size_x()) * static_cast<std::size_t>(size_y()) *
           static_cast<std::size_t>(size_z());
  }
  bool Contains(const VoxelIndex& i) const {
    return i.x >= min.x && i.y >= min.y && i.z >= min.z && i.x < max.x && i.y < max.y && i.z < max.z;
  }
};

/// One value per voxel of a box, x fastest, then y, then z.
template <class T>
class DenseGrid {
 public:
  DenseGrid() = default;
  DenseGrid(const VoxelBox& box, const T& value) : box_(box), values_(box.count(), value) {}

  const VoxelBox& box() const { return box_; }
  std::size_t size() const { return values_.size(); }
  bool Contains(const VoxelIndex& i) const { return box_.Contains(i); }

  std::size_t Offset(const VoxelIndex& i) const {
    return (static_cast<std::size_t>(i.z - box_.min.z) * static_cast<std::size_t>(box_.size_y()) +
            static_cast<std::size_t>(i.y - box_.min.y)) *
               static_cast<std::size_t>(box_.size_x()) +
           static_cast<std::size_t>(i.x - box_.min.x);
  }
  VoxelIndex IndexAt(std::size_t offset) const {
    const auto nx = static_cast<std::size_t>(box_.size_x());
    const auto ny = static_cast<std::size_t>(box_.size_y());
    return {box_.min.x + static_cast<std::int32_t>(offset % nx),
            box_.min.y + static_cast<std::int32_t>(offset / nx % ny),
            box_.min.z + static_cast<std::int32_t>(offset / (nx * ny))};
  }
  std::ptrdiff_t stride_y() const { return box_.size_x(); }
  std::ptrdiff_t stride_z() const { return static_cast<std::ptrdiff_t>(box_.size_x()) * box_.size_y(); }

  T& operator[](std::size_t offset) { return values_[offset]; }
  const T& operator[](std::size_t offset) const { return values_[offset]; }
  T& operator[](const VoxelIndex& i) { return values_[Offset(i)]; }
  const T& operator[](const VoxelIndex& i) const { return values_[Offset(i)]; }

  /// The value at `i`, or `outside` if `i` is not in the box.
  T Get(const VoxelIndex& i, const T& outside) const { return Contains(i) ? values_[Offset(i)] : outside; }

  const T* data() const { return values_.data(); }
  T* data() { return values_.data(); }
  void Fill(const T& value) { std::fill(values_.begin(), values_.end(), value); }

 private:
  VoxelBox box_;
  std::vector<T> values_;
};

}  // namespace thalweg
