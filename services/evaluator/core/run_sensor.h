#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/robot_model.h"
#include "services/evaluator/core/stereo_sensor.h"
#include "services/simulator/core/depth_sensor.h"

namespace thalweg::evaluator {

/// Where the clouds of a run come from: a depth sensor, or a stereo camera.
class RunSensor {
 public:
  /// @param stereo  Empty: the depth sensor.
  /// @param colors  Whether clouds need colors.
  RunSensor(const DepthSensorModel& depth, const std::optional<StereoSensor::Options>& stereo,
            std::uint32_t noise_seed, bool colors)
      : depth_(depth, noise_seed, colors),
        camera_(stereo ? stereo->rig.camera : depth.camera),
        rate_(stereo ? stereo->rate : depth.rate) {
    if (!stereo) return;
    StereoSensor::Options options = *stereo;
    options.rig.color = colors;
    stereo_.emplace(options, noise_seed);
  }

  double rate() const { return rate_; }  ///< [Hz]
  const PinholeCamera& camera() const { return camera_; }
  PointCloud Capture(const simulator::World& world, const RigidTransform& T_WC) {
    return stereo_ ? stereo_->Capture(world, T_WC) : depth_.Capture(world, T_WC);
  }

 private:
  simulator::DepthSensor depth_;
  std::optional<StereoSensor> stereo_;
  PinholeCamera camera_;
  double rate_;
};

}  // namespace thalweg::evaluator
