#include "services/mapper/adapter/options.h"

#include <algorithm>

namespace thalweg::mapper {

MapperOptions OptionsFrom(const Scenario& scenario, const std::filesystem::path& out) {
  MapperOptions options;
  options.out = out;
  options.T_BC = RobotFrom(scenario).T_BC;
  const Mapper& given = scenario.mapper();
  OccupancyMap::Options& map = options.map;
  if (given.has_voxel_size_m()) map.voxel_size = given.voxel_size_m();
  if (given.has_max_range_m()) map.max_range = given.max_range_m();
  if (given.has_min_range_m()) map.min_range = given.min_range_m();
  if (given.has_log_odds_hit()) map.log_odds_hit = static_cast<float>(given.log_odds_hit());
  if (given.has_log_odds_miss()) map.log_odds_miss = static_cast<float>(given.log_odds_miss());
  if (given.has_log_odds_min()) map.log_odds_min = static_cast<float>(given.log_odds_min());
  if (given.has_log_odds_max()) map.log_odds_max = static_cast<float>(given.log_odds_max());
  if (given.has_protect()) map.protect = given.protect();
  if (given.has_fill()) map.fill = given.fill();
  if (given.has_exact_rays()) map.exact_rays = given.exact_rays();
  if (given.has_fill_max_gap_m()) map.fill_max_gap = given.fill_max_gap_m();
  if (given.has_shadow_m()) map.shadow = given.shadow_m();
  if (const DepthSensorModel sensor = DepthSensorFrom(scenario); sensor.no_return_is_free) {
    map.no_return = sensor.camera;
    map.max_range = std::min(map.max_range, sensor.max_range);
  }
  map.depth_error = DepthErrorFrom(scenario);
  if (given.has_min_hit_probability()) map.min_hit_probability = given.min_hit_probability();
  if (given.has_checkpoint_period_s()) options.checkpoint_period = FromSeconds(given.checkpoint_period_s());
  return options;
}

}  // namespace thalweg::mapper
