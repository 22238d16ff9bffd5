#include "services/explorer/core/map/open_border.h"

#include <algorithm>
#include <iterator>

#include "services/explorer/core/map/frontier.h"

namespace thalweg::explorer {
namespace {

bool IsSurface(const PlanningMap& map, const VoxelIndex& i) {
  return std::any_of(std::begin(kFaceNeighbors), std::end(kFaceNeighbors), [&](const VoxelIndex& step) {
    return map.InBounds(i + step) && map.State(i + step) == VoxelState::kFree;
  });
}

}  // namespace

std::size_t OpenBorder::open() const {
  std::size_t sum = 0;
  for (const auto& [reason, voxels] : unknown) sum += voxels;
  return sum;
}

double OpenBorder::share() const {
  const std::size_t border = surface + open();
  return border == 0 ? 0.0 : static_cast<double>(open()) / static_cast<double>(border);
}

double OpenBorder::missed_share() const {
  if (open() > surface) return share();
  std::size_t missed = hidden;
  for (const auto& [reason, voxels] : unknown) {
    const bool not_reached = reason == AsideReason::kLostThere || reason == AsideReason::kNoRoom;
    missed += IsInVain(reason) || not_reached ? voxels : 0;
  }
  return missed == 0 ? 0.0 : static_cast<double>(missed) / static_cast<double>(surface + open());
}

OpenBorder FindOpenBorder(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside) {
  OpenBorder border;
  const DenseGrid<VoxelState>& states = map.states();
  for (std::size_t k = 0; k < states.size(); ++k) {
    if (states[k] == VoxelState::kFree) continue;
    const VoxelIndex i = states.IndexAt(k);
    if (states[k] == VoxelState::kOccupied) {
      if (IsSurface(map, i)) ++border.surface;
      continue;
    }
    if (IsTarget(map, i)) ++border.unknown[static_cast<AsideReason>(set_aside[i])];
  }
  return border;
}

}  // namespace thalweg::explorer
