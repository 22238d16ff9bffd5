#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "common/voxel/voxel_index.h"
#include "services/mapper/core/scan_points.h"

namespace thalweg::mapper {

/// What one scan says about the voxels around the sensor: a dense window of one byte a voxel that moves with
/// the sensor. A dense window costs one store a voxel where a hash set costs a probe; it is kept from scan to
/// scan, so a scan allocates nothing.
///
/// The window is a torus, a power of two of voxels along an edge: a voxel's mark has the same place wherever
/// the sensor is. Marks lie in blocks of 8^3, as OccupancyGrid's voxels do.
class ScanMarks {
 public:
  enum Mark : std::uint8_t {
    kNone = 0,
    kMiss = 1,
    kHit = 2,
    kWeakMiss = 3,  ///< Of a ray whose end is not sure: it makes free, weakly, what is not occupied.
    kSeen = 4,      ///< For the caller, while it collects end points.
  };
  static constexpr std::size_t kBlockVoxels = 512;
  static constexpr int kMaxReach = 400;  ///< [voxels] The window then spans 1 GB of address space.

  /// @param reach  [voxels] No mark is set further from the sensor's voxel, on any axis; 1 to kMaxReach.
  ScanMarks(double voxel_size, int reach);

  /// Moves the window; all marks must have been cleared. @param sensor_W  Within the range of indices.
  void MoveTo(const Eigen::Vector3f& sensor_W);
  const VoxelIndex& sensor_voxel() const { return sensor_voxel_; }

  bool Contains(const VoxelIndex& i) const {
    const VoxelIndex d = i - sensor_voxel_;
    return InReach(d.x) && InReach(d.y) && InReach(d.z);
  }
  /// Where the mark of a voxel within the window is.
  std::uint32_t OffsetOf(const VoxelIndex& i) const {
    return Spread(i.x, 0) | Spread(i.y, 1) | Spread(i.z, 2);
  }
  static constexpr std::uint32_t kOutside = 0xFFFFFFFFU;
  /// OffsetOf each voxel; kOutside for those not within the window.
  void Locate(const VoxelBatch& voxels, std::array<std::uint32_t, VoxelBatch::kSize>& offsets) const;
  std::uint8_t& At(std::uint32_t offset) { return marks_[offset]; }
  /// Of a voxel at most one beyond the window's reach.
  std::uint8_t Get(const VoxelIndex& i) const { return marks_[OffsetOf(i)]; }

  struct Ray {
    Eigen::Vector3f end_W;
    VoxelIndex end;  ///< The voxel of end_W, within the window.
  };
  /// Marks every voxel from the sensor's to the end of each ray, without the last. Overwrites.
  ///
  /// The voxels are those of octomap::OcTree::computeRayKeys, one by one: the traversal of [Amanatides, Woo:
  /// A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987] on single-precision end points,
  /// with the same stop rules, so that they agree even where rounding decides. Four rays go abreast in SIMD
  /// lanes.
  void MarkRays(std::span<const Ray> rays, Mark mark = kMiss);
  /// Sets the mark of a voxel within the window.
  void Set(const VoxelIndex& i, Mark mark) {
    Touch(i);
    marks_[OffsetOf(i)] = mark;
  }

  /// Calls visit(block index, marks of its 512 voxels) for each block that may hold marks.
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
  /// A coordinate's share of the offset: its bits spread out to where its axis has them.
  std::uint32_t Spread(std::int32_t v, int axis) const {
    const auto bits = static_cast<std::uint32_t>(v);
    return (bits & 7U) << (3 * axis) | ((bits >> 3) & (blocks_ - 1)) << (9 + axis * block_bits_);
  }
  /// The bits of the offset that belong to the axis.
  std::uint32_t AxisMask(int axis) const { return Spread(-1, axis); }
  void Touch(const VoxelIndex& i);

  double voxel_size_;
  int reach_;
  int block_bits_ = 0;         ///< The window has 2^block_bits_ blocks along an edge.
  std::uint32_t blocks_ = 1U;  ///< 2^block_bits_
  std::unique_ptr<std::uint8_t[], Free> marks_;
  Eigen::Vector3f sensor_W_ = Eigen::Vector3f::Zero();
  VoxelIndex sensor_voxel_;
  VoxelIndex touched_min_;  ///< Box around all marks.
  VoxelIndex touched_max_;  ///< Inclusive.
};

template <class Visitor>
void ScanMarks::ForEachBlock(Visitor&& visit) const {
  for (int z = touched_min_.z >> 3; z <= touched_max_.z >> 3; ++z) {
    for (int y = touched_min_.y >> 3; y <= touched_max_.y >> 3; ++y) {
      for (int x = touched_min_.x >> 3; x <= touched_max_.x >> 3; ++x) {
        visit(VoxelIndex{x, y, z}, &marks_[OffsetOf({8 * x, 8 * y, 8 * z})]);
      }
    }
  }
}

}  // namespace thalweg::mapper
