#include "services/mapper/core/map_engine.h"

#include <utility>

#include "common/base/check.h"
#include "services/mapper/core/filtered_map.h"
#include "services/mapper/core/octree_map.h"

namespace thalweg::mapper {
namespace {

std::unique_ptr<FusedMap> MakeUnfiltered(MapEngine engine, const OccupancyMap::Options& options,
                                         OccupancyGrid map) {
  switch (engine) {
    case MapEngine::kBlocks:
      return std::make_unique<OccupancyMap>(options, std::move(map));
    case MapEngine::kOctomap:
      return std::make_unique<OctreeMap>(options, map);
  }
  THALWEG_CHECK(!"an engine without a map");
  return nullptr;
}

}  // namespace

std::unique_ptr<FusedMap> MakeMap(MapEngine engine, const OccupancyMap::Options& options,
                                  const FilterOptions& filter) {
  return MakeMap(engine, options, OccupancyGrid(Checked(options).voxel_size), filter);
}

std::unique_ptr<FusedMap> MakeMap(MapEngine engine, const OccupancyMap::Options& options, OccupancyGrid map,
                                  const FilterOptions& filter) {
  auto fused = MakeUnfiltered(engine, options, std::move(map));
  auto made = MakeFilter(filter);
  if (!made) return fused;
  return std::make_unique<FilteredMap>(std::move(made), std::move(fused));
}

}  // namespace thalweg::mapper
