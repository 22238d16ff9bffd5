#pragma once

#include <cstdint>
#include <optional>

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

struct SimulatorOptions {
  RobotModel robot;
  RigidTransform T_WB_start = RigidTransform::Identity();
  DepthSensorModel depth_sensor;
  bool depth_enabled = true;  ///< If false, no clouds are published; another service computes depth.
  std::optional<StereoRigModel> stereo_camera;  ///< Empty: no images.
  double time_scale = 1.0;                      ///< Simulated seconds per second; 0 = as fast as possible.
  double odometry_rate = 50.0;                  ///< [Hz]
  bool is_odometry = true;  ///< Whether the true pose is the odometry; if not, only ground truth.
  std::uint32_t noise_seed = 1;
};

/// Block `simulator`, but for the start (load_mesh.h).
void Visit(OptionVisitor& visitor, SimulatorOptions& options);

/// Throws std::invalid_argument naming the field when the robot does not fit at its start.
SimulatorOptions OptionsFrom(const Scenario& scenario, const World& world);

}  // namespace thalweg::simulator
