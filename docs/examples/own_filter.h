#pragma once

#include <limits>

#include "services/mapper/core/cloud_filter.h"

/// A filter of one's own: drops what the sensor reports within a box before it, such as the robot's own arm.
class ArmFilter final : public thalweg::mapper::CloudFilter {
 public:
  /// @param reach  [m] Depth of the box, along the camera's z axis. @param half_width  [m] Along x and y.
  ArmFilter(float reach, float half_width) : reach_(reach), half_width_(half_width) {}

  void Apply(thalweg::PointCloud& cloud) override {
    for (Eigen::Vector3f& p_C : cloud.points_C) {
      const bool is_beside = p_C.head<2>().cwiseAbs().maxCoeff() > half_width_;
      if (thalweg::IsNoReturn(p_C) || is_beside || p_C.z() > reach_) continue;
      p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }

 private:
  float reach_, half_width_;
};
