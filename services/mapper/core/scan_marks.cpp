#include "services/mapper/core/scan_marks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "common/base/check.h"
#include "common/base/simd.h"

namespace thalweg::mapper {

namespace {

constexpr int kMargin = 3;  // rounding may carry a ray one voxel past its end, and neighbors are read
// GCC and Clang map these to the machine's 128-bit vectors (SSE2, NEON). They would split larger ones.
using Doubles = double __attribute__((vector_size(16)));
using Longs = std::int64_t __attribute__((vector_size(16)));
using Bits = std::int32_t __attribute__((vector_size(16)));  // SSE2 has no 64-bit comparison to select by
constexpr std::size_t kWidth = 2;
// Traced alternately, so that one computes while the other waits for its operands
constexpr std::size_t kPairs = 2;
constexpr std::size_t kLanes = kWidth * kPairs;

/// Two rays being traced, one per lane.
struct RayPair {
  Doubles t_next[3];  ///< Length along the ray at the next crossing of each axis's voxel boundaries.
  Doubles t_step[3];  ///< Length from one crossing to the next.
  Longs at[3];        ///< Current voxel, as each axis's share of the mark's offset.
  Longs move[3];      ///< Added to `at` by a step; the bits of other axes are then masked off.

  /// Steps each ray along the axis crossed first; on a tie along the later axis, as OctoMap does.
  void Step(const Longs (&mask)[3]) {
    const Bits x_before_y = std::bit_cast<Bits>(t_next[0] < t_next[1]);
    const Bits along_x = x_before_y & std::bit_cast<Bits>(t_next[0] < t_next[2]);
    const Bits along_y = ~x_before_y & std::bit_cast<Bits>(t_next[1] < t_next[2]);
    const Bits along_z = ~(along_x | along_y);
    Advance(0, along_x, mask[0]);
    Advance(1, along_y, mask[1]);
    Advance(2, along_z, mask[2]);
  }

 private:
  void Advance(int axis, const Bits& chosen, const Longs& mask) {
    t_next[axis] += std::bit_cast<Doubles>(chosen & std::bit_cast<Bits>(t_step[axis]));
    at[axis] = (at[axis] + std::bit_cast<Longs>(chosen & std::bit_cast<Bits>(move[axis]))) & mask;
  }
};

/// The end of the ray in a lane.
struct RayEnd {
  std::uint32_t last = 0;  ///< Offset of the last voxel's mark.
  double length = 0.0;
};

/// Advances all rays by `steps` steps and marks the voxels they reach.
void MarkSteps(std::array<RayPair, kPairs>& pairs, const Longs (&mask)[3], int steps, ScanMarks::Mark mark,
               std::uint8_t* marks) {
  std::array<RayPair, kPairs> local = pairs;  // a copy that stays in registers
  for (int step = 0; step < steps; ++step) {
    for (RayPair& pair : local) {
      pair.Step(mask);
      const Longs offset = pair.at[0] | pair.at[1] | pair.at[2];
      marks[static_cast<std::size_t>(offset[0])] = mark;
      marks[static_cast<std::size_t>(offset[1])] = mark;
    }
  }
  pairs = local;
}

double NormOf(const Eigen::Vector3f& v) {
  return std::sqrt(static_cast<double>(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
}

}  // namespace

ScanMarks::ScanMarks(double voxel_size, int reach) : voxel_size_(voxel_size), reach_(reach) {
  THALWEG_CHECK(reach > 0 && reach <= kMaxReach);
  while (static_cast<int>(8 * blocks_) < 2 * (reach + kMargin) + 1) {
    ++block_bits_;
    blocks_ *= 2;
  }
  // calloc: pages of a large window that no ray enters take no memory.
  marks_.reset(static_cast<std::uint8_t*>(std::calloc(kBlockVoxels << (3 * block_bits_), 1)));
  if (!marks_) throw std::bad_alloc();
}

void ScanMarks::MoveTo(const Eigen::Vector3f& sensor_W) {
  sensor_W_ = sensor_W;
  sensor_voxel_ = VoxelAt(sensor_W.cast<double>(), voxel_size_);
  touched_min_ = sensor_voxel_;
  touched_max_ = sensor_voxel_;
}

THALWEG_SIMD_CLONES
void ScanMarks::Locate(const VoxelBatch& voxels,
                       std::array<std::uint32_t, VoxelBatch::kSize>& offsets) const {
  const VoxelIndex sensor = sensor_voxel_;
  const auto reach = static_cast<std::uint32_t>(reach_);
  // A number rather than a bool, so that the three axes are joined without a branch.
  const auto beyond = [reach](std::int32_t v, std::int32_t from) {
    return std::uint32_t{static_cast<std::uint32_t>(v) - static_cast<std::uint32_t>(from) + reach >
                         2U * reach};
  };
  const std::uint32_t blocks = blocks_ - 1;
  const int bits = block_bits_;
  for (std::size_t k = 0; k < VoxelBatch::kSize; ++k) {
    const auto x = static_cast<std::uint32_t>(voxels.x[k]);
    const auto y = static_cast<std::uint32_t>(voxels.y[k]);
    const auto z = static_cast<std::uint32_t>(voxels.z[k]);
    const std::uint32_t within_block = (x & 7U) | (y & 7U) << 3 | (z & 7U) << 6;
    const std::uint32_t block =
        (x >> 3 & blocks) | (y >> 3 & blocks) << bits | (z >> 3 & blocks) << (2 * bits);
    const std::uint32_t outside =
        beyond(voxels.x[k], sensor.x) | beyond(voxels.y[k], sensor.y) | beyond(voxels.z[k], sensor.z);
    offsets[k] = outside != 0 ? kOutside : within_block | block << 9;
  }
}

void ScanMarks::Touch(const VoxelIndex& i) {
  touched_min_ = {std::min(touched_min_.x, i.x), std::min(touched_min_.y, i.y),
                  std::min(touched_min_.z, i.z)};
  touched_max_ = {std::max(touched_max_.x, i.x), std::max(touched_max_.y, i.y),
                  std::max(touched_max_.z, i.z)};
}

void ScanMarks::MarkRays(std::span<const Ray> rays, Mark mark) {
  std::array<RayPair, kPairs> pairs{};
  std::array<RayEnd, kLanes> ends;
  constexpr int kIdle = std::numeric_limits<int>::max();
  std::array<int, kLanes> left{};  // steps that need no test for the ray's end
  auto next = rays.begin();
  const std::int32_t first[3] = {sensor_voxel_.x, sensor_voxel_.y, sensor_voxel_.z};
  Longs mask[3];
  for (int axis = 0; axis < 3; ++axis) mask[axis] = Longs{} + static_cast<std::int64_t>(AxisMask(axis));

  const auto start_next = [&](std::size_t lane) {
    RayPair& pair = pairs[lane / kWidth];
    const std::size_t slot = lane % kWidth;
    while (next != rays.end() && next->end == sensor_voxel_) ++next;
    if (next == rays.end()) {  // an idle lane keeps marking the sensor's voxel
      left[lane] = kIdle;
      for (int axis = 0; axis < 3; ++axis) {
        pair.at[axis][slot] = Spread(first[axis], axis);
        pair.move[axis][slot] = 0;
      }
      return;
    }
    const Ray& ray = *next++;
    Touch(ray.end);
    Eigen::Vector3f direction = ray.end_W - sensor_W_;
    const auto length = static_cast<float>(NormOf(direction));
    ends[lane] = {.last = OffsetOf(ray.end), .length = static_cast<double>(length)};
    for (int axis = 0; axis < 3; ++axis) {
      direction[axis] /= length;
      const auto along = static_cast<double>(direction[axis]);
      pair.at[axis][slot] = Spread(first[axis], axis);
      if (direction[axis] == 0.0F) {
        pair.t_next[axis][slot] = pair.t_step[axis][slot] = std::numeric_limits<double>::max();
        pair.move[axis][slot] = 0;
        continue;
      }
      const double half = along > 0.0 ? 0.5 * voxel_size_ : -0.5 * voxel_size_;
      const double boundary =
          (first[axis] + 0.5) * voxel_size_ + static_cast<double>(static_cast<float>(half));
      pair.t_next[axis][slot] = (boundary - static_cast<double>(sensor_W_[axis])) / along;
      pair.t_step[axis][slot] = voxel_size_ / std::abs(along);
      // The bits of the other axes lie among this axis's own. For a step up they are all set, so that the
      // carry propagates through them; for a step down all are clear, so that the borrow does.
      const auto own = static_cast<std::int64_t>(AxisMask(axis));
      pair.move[axis][slot] = along > 0.0 ? -own : -(own & -own);
    }
    // The last voxel is this many steps away; rounding costs at most one step per axis.
    const VoxelIndex offset = ray.end - sensor_voxel_;
    left[lane] = std::max(0, std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z) - 4);
  };

  // Takes the last steps one by one, with OctoMap's two stop conditions.
  const auto finish = [&](std::size_t lane) {
    const RayPair& pair = pairs[lane / kWidth];
    const std::size_t slot = lane % kWidth;
    double t_next[3];
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      t_next[axis] = pair.t_next[axis][slot];
      at[axis] = pair.at[axis][slot];
    }
    const auto soonest = [&t_next] {
      if (t_next[0] < t_next[1]) return t_next[0] < t_next[2] ? 0 : 2;
      return t_next[1] < t_next[2] ? 1 : 2;
    };
    for (int axis = soonest();;) {
      at[axis] = (at[axis] + pair.move[axis][slot]) & mask[axis][slot];
      t_next[axis] += pair.t_step[axis][slot];
      const auto offset = static_cast<std::uint32_t>(at[0] | at[1] | at[2]);
      if (offset == ends[lane].last) return;
      axis = soonest();
      if (t_next[axis] > ends[lane].length) return;
      marks_[offset] = mark;
    }
  };

  for (std::size_t lane = 0; lane < kLanes; ++lane) start_next(lane);
  if (std::ranges::all_of(left, [](int steps) { return steps == kIdle; })) return;
  marks_[OffsetOf(sensor_voxel_)] = mark;
  for (;;) {
    const int steps = *std::ranges::min_element(left);
    if (steps == kIdle) return;
    MarkSteps(pairs, mask, steps, mark, marks_.get());
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (left[lane] == kIdle) continue;
      left[lane] -= steps;
      if (left[lane] > 0) continue;
      finish(lane);
      start_next(lane);
    }
  }
}

void ScanMarks::Clear() {
  ForEachVoxel(TouchedBlocks(), [&](const VoxelIndex& block) {
    std::memset(&marks_[OffsetOfBlock(block)], kNone, kBlockVoxels);
  });
}

}  // namespace thalweg::mapper
