#include "services/mapper/core/scan_marks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "common/base/check.h"

namespace thalweg::mapper {

namespace {
constexpr int kMargin = 2;  // rounding may carry a ray one voxel past its end
}

ScanMarks::ScanMarks(double voxel_size, int reach) : voxel_size_(voxel_size) {
  THALWEG_CHECK(reach > 0 && reach <= kMaxReach);
  blocks_ = 2 * ((reach + kMargin + kBlockEdge - 1) / kBlockEdge) + 1;
  edge_ = blocks_ * kBlockEdge;
  std::uint32_t within_block = 1;
  std::uint32_t between_blocks = kBlockVoxels;
  for (std::vector<std::uint32_t>& offsets : offsets_) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(edge_); ++i) {
      offsets.push_back((i % kBlockEdge) * within_block + (i / kBlockEdge) * between_blocks);
    }
    within_block *= kBlockEdge;
    between_blocks *= static_cast<std::uint32_t>(blocks_);
  }
  // calloc: pages of a large window that no ray enters cost nothing.
  marks_.reset(static_cast<std::uint8_t*>(std::calloc(static_cast<std::size_t>(between_blocks), 1)));
  if (!marks_) throw std::bad_alloc();
}

void ScanMarks::MoveTo(const Eigen::Vector3f& sensor_W) {
  sensor_W_ = sensor_W;
  sensor_voxel_ = VoxelAt(sensor_W.cast<double>(), voxel_size_);
  const auto first = [this](std::int32_t v) { return ((v >> 3) - blocks_ / 2) * kBlockEdge; };
  min_ = {first(sensor_voxel_.x), first(sensor_voxel_.y), first(sensor_voxel_.z)};
  touched_min_ = sensor_voxel_;
  touched_max_ = sensor_voxel_;
}

void ScanMarks::Touch(const VoxelIndex& i) {
  touched_min_ = {std::min(touched_min_.x, i.x), std::min(touched_min_.y, i.y),
                  std::min(touched_min_.z, i.z)};
  touched_max_ = {std::max(touched_max_.x, i.x), std::max(touched_max_.y, i.y),
                  std::max(touched_max_.z, i.z)};
}

void ScanMarks::Set(const VoxelIndex& i, Mark mark) {
  Touch(i);
  marks_[OffsetOf(i)] = mark;
}

void ScanMarks::MarkRay(const Eigen::Vector3f& end_W, const VoxelIndex& end) {
  if (end == sensor_voxel_) return;
  Touch(end);
  Eigen::Vector3f direction = end_W - sensor_W_;
  const float length = static_cast<float>(std::sqrt(static_cast<double>(direction.x() * direction.x() +  //
                                                                        direction.y() * direction.y() +  //
                                                                        direction.z() * direction.z())));
  const int first[3] = {sensor_voxel_.x, sensor_voxel_.y, sensor_voxel_.z};
  const int base[3] = {min_.x, min_.y, min_.z};
  const std::uint32_t* next[3];  // into offsets_, at the current voxel
  std::ptrdiff_t step[3] = {0, 0, 0};
  double t_next[3];  // length along the ray at the next crossing of each axis
  double t_step[3];
  for (int axis = 0; axis < 3; ++axis) {
    direction[axis] /= length;
    next[axis] = offsets_[static_cast<std::size_t>(axis)].data() + (first[axis] - base[axis]);
    t_next[axis] = t_step[axis] = std::numeric_limits<double>::max();
    if (direction[axis] == 0.0F) continue;
    step[axis] = direction[axis] > 0.0F ? 1 : -1;
    const double boundary =
        (first[axis] + 0.5) * voxel_size_ +
        static_cast<double>(static_cast<float>(static_cast<double>(step[axis]) * voxel_size_ * 0.5));
    t_next[axis] = (boundary - static_cast<double>(sensor_W_[axis])) / static_cast<double>(direction[axis]);
    t_step[axis] = voxel_size_ / std::abs(static_cast<double>(direction[axis]));
  }
  const std::uint32_t last = OffsetOf(end);
  std::uint32_t offset = OffsetOf(sensor_voxel_);
  const auto soonest = [&t_next] {
    if (t_next[0] < t_next[1]) return t_next[0] < t_next[2] ? 0 : 2;
    return t_next[1] < t_next[2] ? 1 : 2;
  };
  marks_[offset] = kMiss;
  for (int axis = soonest();;) {
    const std::uint32_t before = *next[axis];
    next[axis] += step[axis];
    offset += *next[axis] - before;
    t_next[axis] += t_step[axis];
    if (offset == last) return;
    axis = soonest();
    if (t_next[axis] > static_cast<double>(length)) return;  // rounding led past the last voxel
    marks_[offset] = kMiss;
  }
}

void ScanMarks::Clear() {
  ForEachTouched(
      [this](const VoxelIndex&, std::size_t offset) { std::memset(&marks_[offset], kNone, kBlockVoxels); });
}

}  // namespace thalweg::mapper
