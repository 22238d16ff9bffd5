#include "services/explorer/core/map/free_frontier.h"

#include <algorithm>
#include <iterator>

namespace thalweg::explorer {

bool IsOpenUnknown(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside, const VoxelIndex& i) {
  return map.State(i) == VoxelState::kUnknown && map.InBounds(i) && set_aside.Get(i, 0) == 0;
}

std::vector<VoxelIndex> FreeFrontier(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside) {
  std::vector<VoxelIndex> frontier;
  const DenseGrid<VoxelState>& states = map.states();
  for (std::size_t k = 0; k < states.size(); ++k) {
    if (states[k] != VoxelState::kFree) continue;
    const VoxelIndex i = states.IndexAt(k);
    if (!map.InBounds(i)) continue;
    const bool open = std::ranges::any_of(
        kFaceNeighbors, [&](const VoxelIndex& step) { return IsOpenUnknown(map, set_aside, i + step); });
    if (open) frontier.push_back(i);
  }
  return frontier;
}

}  // namespace thalweg::explorer
