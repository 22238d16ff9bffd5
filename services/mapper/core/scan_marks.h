#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "common/voxel/voxel_index.h"

namespace thalweg::mapper {

/// What one scan says about the voxels around the sensor: a dense window of one byte a voxel, stored in
/// blocks of 8^3 as OccupancyGrid is, that moves with the sensor. A dense window costs one add and one store
/// a voxel where a hash set costs a probe; it is kept from scan to scan, so a scan allocates nothing.
///
/// Rays are those of octomap::OcTree::computeRayKeys, voxel by voxel: the traversal of [Amanatides, Woo: A
/// Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987] on single-precision end points, with
/// the same stop rules, so that the same voxels are crossed even where rounding decides.
class ScanMarks {
 public:
  enum Mark : std::uint8_t {
    kNone = 0,
    kMiss = 1,
    kHit = 2,
    kSeen = 3,  ///< For the caller, while it collects end points.
  };
  static constexpr int kBlockEdge = 8;
  static constexpr std::size_t kBlockVoxels = 512;
  static constexpr int kMaxReach = 400;  ///< [voxels] The window then spans 0.5 GB of address space.

  /// @param reach  [voxels] No mark is set further from the sensor's voxel, on any axis; <= kMaxReach.
  ScanMarks(double voxel_size, int reach);

  /// Moves the window; all marks must have been cleared.
  void MoveTo(const Eigen::Vector3f& sensor_W);
  const VoxelIndex& sensor_voxel() const { return sensor_voxel_; }

  bool Contains(const VoxelIndex& i) const {
    const auto inside = [this](std::int32_t v, std::int32_t min) {
      return static_cast<std::uint32_t>(v - min) < static_cast<std::uint32_t>(edge_);
    };
    return inside(i.x, min_.x) && inside(i.y, min_.y) && inside(i.z, min_.z);
  }
  /// Where the mark of a voxel within the window is.
  std::uint32_t OffsetOf(const VoxelIndex& i) const {
    return offsets_[0][static_cast<std::size_t>(i.x - min_.x)] +
           offsets_[1][static_cast<std::size_t>(i.y - min_.y)] +
           offsets_[2][static_cast<std::size_t>(i.z - min_.z)];
  }
  std::uint8_t& At(std::uint32_t offset) { return marks_[offset]; }
  /// Of any voxel; kNone outside the window.
  std::uint8_t Get(const VoxelIndex& i) const {
    return Contains(i) ? marks_[OffsetOf(i)] : static_cast<std::uint8_t>(kNone);
  }

  /// Marks as kMiss every voxel from the sensor's to that of `end_W`, without the last. Overwrites.
  /// @param end  The voxel of end_W, within the window.
  void MarkRay(const Eigen::Vector3f& end_W, const VoxelIndex& end);
  /// Sets the mark of a voxel within the window.
  void Set(const VoxelIndex& i, Mark mark);

  /// Calls visit(block index, marks of its 512 voxels) for each block that may hold marks.
  template <class Visitor>
  void ForEachBlock(Visitor&& visit) const {
    ForEachTouched([&](const VoxelIndex& block, std::size_t offset) { visit(block, &marks_[offset]); });
  }
  void Clear();

 private:
  struct Free {
    void operator()(std::uint8_t* memory) const { std::free(memory); }
  };
  template <class Visitor>
  void ForEachTouched(Visitor&& visit) const;
  void Touch(const VoxelIndex& i);

  double voxel_size_;
  int blocks_;  ///< Along an edge of the window.
  int edge_;    ///< [voxels]
  std::array<std::vector<std::uint32_t>, 3> offsets_;
  std::unique_ptr<std::uint8_t[], Free> marks_;
  Eigen::Vector3f sensor_W_ = Eigen::Vector3f::Zero();
  VoxelIndex sensor_voxel_;
  VoxelIndex min_;  ///< First voxel of the window, a multiple of 8 on each axis.
  VoxelIndex touched_min_;
  VoxelIndex touched_max_;  ///< Inclusive.
};

template <class Visitor>
void ScanMarks::ForEachTouched(Visitor&& visit) const {
  const auto block_of = [](const VoxelIndex& i) { return VoxelIndex{i.x >> 3, i.y >> 3, i.z >> 3}; };
  const VoxelIndex first = block_of(min_);
  const VoxelIndex low = block_of(touched_min_);
  const VoxelIndex high = block_of(touched_max_);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const std::size_t block = (static_cast<std::size_t>(z - first.z) * static_cast<std::size_t>(blocks_) +
                                   static_cast<std::size_t>(y - first.y)) *
                                      static_cast<std::size_t>(blocks_) +
                                  static_cast<std::size_t>(x - first.x);
        visit(VoxelIndex{x, y, z}, block * kBlockVoxels);
      }
    }
  }
}

}  // namespace thalweg::mapper
