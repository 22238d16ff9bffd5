#include "services/explorer/core/path/reach_changes.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "common/base/check.h"
#include "common/base/simd.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/moved_grid.h"

namespace thalweg::explorer {
namespace {

constexpr int kEdgeBits = 3;  // of a block
constexpr int kEdge = 1 << kEdgeBits;
constexpr auto kNothing = static_cast<std::uint8_t>(VoxelState::kUnknown);  // and not reached
constexpr std::uint8_t kReachedBit = 4;

THALWEG_SIMD_CLONES
void Encode(const VoxelState* states, const std::uint32_t* costs, std::size_t count, std::uint8_t* codes) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t reached = costs[k] != PathSearch::kUnreached ? kReachedBit : std::uint8_t{0};
    codes[k] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(states[k]) | reached);
  }
}

}  // namespace

VoxelBox ReachChanges::BlocksOf(const VoxelBox& box) {
  return {{box.min.x >> kEdgeBits, box.min.y >> kEdgeBits, box.min.z >> kEdgeBits},
          {((box.max.x - 1) >> kEdgeBits) + 1, ((box.max.y - 1) >> kEdgeBits) + 1,
           ((box.max.z - 1) >> kEdgeBits) + 1}};
}

void ReachChanges::Update(const PlanningMap& map, const PathSearch& search) {
  ++now_;
  const VoxelBox& box = map.box();
  if (box.count() == 0) return;
  THALWEG_CHECK(search.costs().box() == box);
  if (!(Intersection(before_.box(), box) == before_.box())) {  // it begins again
    before_ = DenseGrid<std::uint8_t>(box, kNothing);
    last_ = DenseGrid<std::uint32_t>(BlocksOf(box), now_);
  }
  if (!(before_.box() == box)) {
    before_ = MovedTo(before_, box, kNothing);
    last_ = MovedTo(last_, BlocksOf(box), std::uint32_t{0});
  }
  const auto length = static_cast<std::size_t>(box.size_x());
  std::vector<std::uint8_t> row(length);
  for (int z = box.min.z; z < box.max.z; ++z) {
    for (int y = box.min.y; y < box.max.y; ++y) {
      const std::size_t begin = before_.Offset({box.min.x, y, z});
      std::uint8_t* const its = before_.data() + begin;
      Encode(map.states().data() + begin, search.costs().data() + begin, length, row.data());
      if (std::memcmp(its, row.data(), length) == 0) continue;
      for (int x = box.min.x; x < box.max.x;) {
        const int end = std::min(((x >> kEdgeBits) + 1) * kEdge, box.max.x);
        const auto at = static_cast<std::size_t>(x - box.min.x);
        if (std::memcmp(its + at, row.data() + at, static_cast<std::size_t>(end - x)) != 0)
          last_[VoxelIndex{x >> kEdgeBits, y >> kEdgeBits, z >> kEdgeBits}] = now_;
        x = end;
      }
      std::memcpy(its, row.data(), length);
    }
  }
}

std::uint32_t ReachChanges::LastIn(const VoxelBox& box) const {
  std::uint32_t last = 0;
  ForEachVoxel(Intersection(BlocksOf(box), last_.box()),
               [&](const VoxelIndex& block) { last = std::max(last, last_[block]); });
  return last;
}

}  // namespace thalweg::explorer
