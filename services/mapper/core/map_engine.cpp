#include "services/mapper/core/map_engine.h"

#include <utility>

#include "common/base/check.h"
#include "services/mapper/core/octree_map.h"

namespace thalweg::mapper {

std::unique_ptr<FusedMap> MakeMap(MapEngine engine, const OccupancyMap::Options& options) {
  return MakeMap(engine, options, OccupancyGrid(Checked(options).voxel_size));
}

std::unique_ptr<FusedMap> MakeMap(MapEngine engine, const OccupancyMap::Options& options, OccupancyGrid map) {
  switch (engine) {
    case MapEngine::kBlocks:
      return std::make_unique<OccupancyMap>(options, std::move(map));
    case MapEngine::kOctomap:
      return std::make_unique<OctreeMap>(options, map);
  }
  THALWEG_CHECK(!"an engine without a map");
  return nullptr;
}

}  // namespace thalweg::mapper
