#include "services/explorer/core/path/island.h"

#include <vector>

namespace thalweg::explorer {
namespace {

/// The cells of a layer that steps past reached ones connect with the first. Marks them as visited.
std::vector<VoxelIndex> NotReachedWith(const VoxelIndex& first, const PathSearch& search,
                                       DenseGrid<std::uint8_t>& visited) {
  std::vector<VoxelIndex> cells = {first};
  visited[first] = 1;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const VoxelIndex at = cells[n];
    for (const VoxelIndex& step : kStepsInPlane) {
      const VoxelIndex next = at + step;
      if (visited.Get(next, 1) != 0 || search.Reached(next)) continue;
      visited[next] = 1;
      cells.push_back(next);
    }
  }
  return cells;
}

bool IsOccupiedInBand(const PlanningMap& map, const VoxelIndex& cell) {
  for (int z = map.bounds().min.z; z < map.bounds().max.z; ++z) {
    if (map.State({cell.x, cell.y, z}) == VoxelState::kOccupied) return true;
  }
  return false;
}

}  // namespace

std::optional<Eigen::Vector3d> FindIsland(const PlanningMap& map, const PathSearch& search) {
  if (!map.plane() || map.box().count() == 0) return std::nullopt;
  VoxelBox layer = map.box();
  layer.min.z = map.IndexOf({0.0, 0.0, *map.plane()}).z;
  layer.max.z = layer.min.z + 1;
  DenseGrid<std::uint8_t> visited(layer, 0);
  // What is reached lies inside the box's faces, so its first cell lies outside.
  NotReachedWith(layer.min, search, visited);
  for (std::size_t k = 0; k < visited.size(); ++k) {
    const VoxelIndex first = visited.IndexAt(k);
    if (visited[k] != 0 || search.Reached(first)) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int occupied = 0;
    for (const VoxelIndex& cell : NotReachedWith(first, search, visited)) {
      if (!IsOccupiedInBand(map, cell)) continue;
      sum += map.CenterOf(cell);
      ++occupied;
    }
    if (occupied > 0) return sum / occupied;
  }
  return std::nullopt;
}

}  // namespace thalweg::explorer
