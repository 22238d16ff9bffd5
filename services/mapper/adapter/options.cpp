#include "services/mapper/adapter/options.h"

#include <algorithm>

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"

namespace thalweg::mapper {

void Visit(OptionVisitor& visitor, MapperOptions& options) {
  OccupancyMap::Options& map = options.map;
  visitor.Choice("engine", options.engine,
                 {{"BLOCKS", MapEngine::kBlocks}, {"OCTOMAP", MapEngine::kOctomap}});
  visitor.Number("min_range_m", map.min_range);
  visitor.Number("log_odds_hit", map.log_odds_hit);
  visitor.Number("log_odds_miss", map.log_odds_miss);
  visitor.Number("log_odds_min", map.log_odds_min);
  visitor.Number("log_odds_max", map.log_odds_max);
  visitor.Switch("protect", map.protect);
  visitor.Switch("fill", map.fill);
  visitor.Number("fill_max_gap_m", map.fill_max_gap);
  visitor.Seconds("checkpoint_period_s", options.checkpoint_period);
  visitor.Switch("exact_rays", map.exact_rays);
  visitor.Number("shadow_m", map.shadow);
  visitor.Number("min_hit_probability", map.min_hit_probability);
}

MapperOptions OptionsFrom(const Scenario& scenario, const std::filesystem::path& out) {
  MapperOptions options;
  options.out = out;
  options.T_BC = RobotFrom(scenario).T_BC;
  options.reads_images = scenario.depth_source() == DepthSource::DEPTH_IMAGE;
  const bool external = options.reads_images || scenario.depth_source() == DepthSource::EXTERNAL;
  // Stereo leaves out the images that come while it is busy.
  options.counts_gaps = scenario.depth_source() != DepthSource::STEREO;
  options.states_camera =
      !external || scenario.robot().has_camera_position_m() || scenario.robot().has_camera_pitch_deg();
  const MapModel model = MapFrom(scenario);
  OccupancyMap::Options& map = options.map;
  options.filter = model.filter;
  map.voxel_size = model.voxel_size;
  map.max_range = model.max_range;
  if (const DepthSensorModel sensor = DepthSensorFrom(scenario); sensor.no_return_is_free) {
    map.no_return = sensor.camera;
    map.max_range = std::min(map.max_range, sensor.max_range);
  }
  map.depth_error = DepthErrorFrom(scenario);
  ReadOptions(scenario.mapper(), options);
  return options;
}

}  // namespace thalweg::mapper
