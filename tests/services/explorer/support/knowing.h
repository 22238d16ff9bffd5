#pragma once

#include "services/explorer/core/knowledge.h"

/// What a robot knows, for tests of what is done with it.
namespace thalweg::explorer::test {

/// Options for a flying sphere with the default camera at its center, which looks 2 m far.
inline Knowledge::Options KnowingOptions() {
  return {.map = {.voxel_size = 0.1, .clearance = 0.15, .bounds = {}},
          .memory = {},
          .robot = {},
          .camera = DepthSensorModel{}.camera,
          .look_range = 2.0,
          .min_measured_share = 0.5,
          .reach = 0.3};
}

/// The same after an update.
inline Knowledge Knowing(std::span<const VoxelChange> changes,
                         const Knowledge::Options& options = KnowingOptions()) {
  Knowledge knowledge(options);
  knowledge.Update(changes, {}, Time{});
  return knowledge;
}

/// Some time after that update.
inline constexpr Time kNow{std::chrono::seconds(100)};

}  // namespace thalweg::explorer::test
