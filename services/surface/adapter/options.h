#pragma once

#include <filesystem>

#include "common/base/option_visitor.h"
#include "common/base/time.h"
#include "common/geometry/pose_continuity.h"
#include "common/geometry/robot_model.h"
#include "common/scenario/scenario.h"
#include "services/surface/core/fused/fused_surface.h"

namespace thalweg::surface {

struct SurfaceServiceOptions {
  FusedSurface::Options surface;
  PoseContinuity::Options continuity;
  RigidTransform T_BC = RobotModel{}.T_BC;
  bool reads_images = false;        ///< Depth images with their calibration, instead of clouds.
  bool infinity_is_free = false;    ///< Whether a depth of +infinity means that nothing is in range.
  std::filesystem::path out = ".";  ///< Folder of the checkpoint and the mesh.
  Duration publish_period = FromSeconds(1.0);      ///< Between updates of the mesh.
  Duration checkpoint_period = FromSeconds(10.0);  ///< 0 = checkpoints are neither written nor read.
  Duration full_copy_period = FromSeconds(1.0);    ///< Shortest time between full copies.
  std::size_t most_update_bytes = 4'000'000;       ///< More blocks make several updates.
};

/// Block `surface`.
void Visit(OptionVisitor& visitor, SurfaceServiceOptions& options);

/// The only code that knows both the scenario and the core's options.
SurfaceServiceOptions OptionsFrom(const Scenario& scenario, const std::filesystem::path& out);

}  // namespace thalweg::surface
