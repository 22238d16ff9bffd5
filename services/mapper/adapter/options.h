#pragma once

#include <filesystem>

#include "common/base/option_visitor.h"
#include "common/base/time.h"
#include "common/geometry/map_model.h"
#include "common/geometry/robot_model.h"
#include "common/scenario/scenario.h"
#include "services/mapper/core/map_engine.h"

namespace thalweg::mapper {

struct MapperOptions {
  OccupancyMap::Options map;
  MapEngine engine = MapEngine::kBlocks;
  FilterModel filter;
  RigidTransform T_BC = RobotModel{}.T_BC;
  bool reads_images = false;        ///< Depth images with their calibration, instead of clouds.
  bool counts_gaps = false;         ///< Whether the clouds' period shows which are missing.
  bool states_camera = true;        ///< Whether tf_static is to state T_BC: not if it was only assumed.
  std::filesystem::path out = ".";  ///< Folder of the checkpoint and the maps.
  Duration checkpoint_period = FromSeconds(5.0);  ///< 0 = checkpoints are neither written nor read.
  /// Period of the Octomap for tools, which is published only when it has changed.
  Duration snapshot_period = FromSeconds(3.0);
  Duration full_copy_period = FromSeconds(0.2);  ///< Shortest time between full copies.
};

/// Block `mapper`, except for what several services read from it (common/scenario/models.h).
void Visit(OptionVisitor& visitor, MapperOptions& options);

/// The only code that knows both the scenario and the core's options.
MapperOptions OptionsFrom(const Scenario& scenario, const std::filesystem::path& out);

}  // namespace thalweg::mapper
