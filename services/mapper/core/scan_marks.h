#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/occupancy_grid.h"
#include "common/voxel/voxel_index.h"
#include "services/mapper/core/scan_points.h"

namespace thalweg::mapper {

/// What one scan says about the voxels around the sensor: a dense window that moves with the sensor, one byte
/// per voxel. Setting a mark costs one store, where a hash set would cost a probe. The window is kept from
/// scan to scan, so that a scan allocates nothing.
///
/// The window is a torus whose edge is a power of two of voxels, so that a voxel's mark stays in the same
/// place wherever the sensor moves. Marks are stored in blocks of 8^3, like the voxels of OccupancyGrid.
class ScanMarks {
 public:
  enum Mark : std::uint8_t {
    kNone = 0,
    kMiss = 1,
    kHit = 2,
    kWeakMiss = 3,  ///< From a ray whose end is uncertain: makes a voxel weakly free unless it is occupied.
    kSeen = 4,      ///< For use by the caller while it collects end points.
  };
  static constexpr std::size_t kBlockVoxels = OccupancyGrid::kBlockVoxels;
  static constexpr int kMaxReach = 400;  ///< [voxels] The window then spans 1 GB of address space.

  /// @param reach  [voxels] Largest distance of a mark from the sensor's voxel along any axis, 1 to
  ///   kMaxReach.
  ScanMarks(double voxel_size, int reach);

  /// Moves the window to the sensor. All marks must have been cleared before.
  /// @param sensor_W  Must lie within the range of voxel indices.
  void MoveTo(const Eigen::Vector3f& sensor_W);
  const VoxelIndex& sensor_voxel() const { return sensor_voxel_; }

  bool Contains(const VoxelIndex& i) const {
    const VoxelIndex d = i - sensor_voxel_;
    return InReach(d.x) && InReach(d.y) && InReach(d.z);
  }
  /// Offset of the mark of a voxel within the window.
  std::uint32_t OffsetOf(const VoxelIndex& i) const {
    return Spread(i.x, 0) | Spread(i.y, 1) | Spread(i.z, 2);
  }
  static constexpr std::uint32_t kOutside = 0xFFFFFFFFU;
  /// Computes OffsetOf for each voxel; kOutside for those outside the window.
  void Locate(const VoxelBatch& voxels, std::array<std::uint32_t, VoxelBatch::kSize>& offsets) const;
  std::uint8_t& At(std::uint32_t offset) { return marks_[offset]; }
  /// Mark of a voxel at most one voxel beyond the window's reach.
  std::uint8_t Get(const VoxelIndex& i) const { return marks_[OffsetOf(i)]; }

  struct Ray {
    Eigen::Vector3f end_W;
    VoxelIndex end;  ///< The voxel of end_W, within the window.
  };
  /// Marks every voxel from the sensor's up to, but excluding, the end of each ray. Overwrites earlier marks.
  ///
  /// The voxels are exactly those of octomap::OcTree::computeRayKeys: the traversal of [Amanatides, Woo: A
  /// Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987] on single-precision end points, with
  /// the same stop conditions, so that the two agree even where rounding decides. Four rays are traced in
  /// parallel in SIMD lanes.
  void MarkRays(std::span<const Ray> rays, Mark mark = kMiss);
  /// Sets the mark of a voxel within the window.
  void Set(const VoxelIndex& i, Mark mark) {
    Touch(i);
    marks_[OffsetOf(i)] = mark;
  }

  /// Calls visit(block index, marks of its 512 voxels) for each block that may contain marks.
  template <class Visitor>
  void ForEachBlock(Visitor&& visit) const;
  void Clear();

 private:
  struct Free {
    void operator()(std::uint8_t* memory) const { std::free(memory); }
  };
  bool InReach(std::int32_t d) const {
    return static_cast<std::uint32_t>(d + reach_) <= 2 * static_cast<std::uint32_t>(reach_);
  }
  /// A coordinate's share of the offset: its bits, spread out to the positions reserved for its axis.
  std::uint32_t Spread(std::int32_t v, int axis) const {
    const auto bits = static_cast<std::uint32_t>(v);
    return (bits & 7U) << (3 * axis) | ((bits >> 3) & (blocks_ - 1)) << (9 + axis * block_bits_);
  }
  /// The bits of the offset that belong to the axis.
  std::uint32_t AxisMask(int axis) const { return Spread(-1, axis); }
  void Touch(const VoxelIndex& i);

  double voxel_size_;
  int reach_;
  int block_bits_ = 0;         ///< The window's edge is 2^block_bits_ blocks.
  std::uint32_t blocks_ = 1U;  ///< 2^block_bits_
  std::unique_ptr<std::uint8_t[], Free> marks_;
  Eigen::Vector3f sensor_W_ = Eigen::Vector3f::Zero();
  VoxelIndex sensor_voxel_;
  VoxelIndex touched_min_;  ///< Bounding box of all marks.
  VoxelIndex touched_max_;  ///< Inclusive.

  VoxelBox TouchedBlocks() const {
    const auto block_of = [](const VoxelIndex& i) { return VoxelIndex{i.x >> 3, i.y >> 3, i.z >> 3}; };
    return {block_of(touched_min_), block_of(touched_max_) + VoxelIndex{1, 1, 1}};
  }
  std::size_t OffsetOfBlock(const VoxelIndex& block) const {
    return OffsetOf({8 * block.x, 8 * block.y, 8 * block.z});
  }
};

template <class Visitor>
void ScanMarks::ForEachBlock(Visitor&& visit) const {
  ForEachVoxel(TouchedBlocks(),
               [&](const VoxelIndex& block) { visit(block, &marks_[OffsetOfBlock(block)]); });
}

}  // namespace thalweg::mapper
