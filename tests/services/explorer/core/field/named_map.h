#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/random_maps.h"

/// Maps to solve fields on, and what of them a field reaches.
namespace thalweg::explorer::test {

struct NamedMap {
  std::string name;
  testing::FieldMap map;
};

/// The cells that a path of free cells connects to a cell with given phi.
inline DenseGrid<std::uint8_t> Reached(const testing::FieldMap& map) {
  DenseGrid<std::uint8_t> reached(map.box(), 0);
  std::vector<VoxelIndex> queue;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] == FieldCell::kSource || IsSink(map[i])) queue.push_back(map.IndexAt(i));
  }
  for (std::size_t k = 0; k < queue.size(); ++k) {
    for (const VoxelIndex& d : kFaceNeighbors) {
      const VoxelIndex next = queue[k] + d;
      if (map.Get(next, FieldCell::kWall) != FieldCell::kFree || reached[next] != 0) continue;
      reached[next] = 1;
      queue.push_back(next);
    }
  }
  return reached;
}

}  // namespace thalweg::explorer::test
