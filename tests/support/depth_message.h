#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "common/dds/convert.h"
#include "common/geometry/point_cloud.h"

namespace thalweg::test {

/// The depths of an organized cloud as a sensor sends them, 32FC1.
inline sensor_msgs::msg::Image DepthMessage(Time stamp, const PointCloud& cloud) {
  sensor_msgs::msg::Image message;
  message.header(dds::MakeHeader(stamp, dds::kCameraFrame));
  message.width(static_cast<std::uint32_t>(cloud.width_px));
  message.height(static_cast<std::uint32_t>(cloud.height_px));
  message.encoding("32FC1");
  message.step(message.width() * sizeof(float));
  for (const Eigen::Vector3f& p_C : cloud.points_C) {
    const auto depth = std::bit_cast<std::array<std::uint8_t, sizeof(float)>>(p_C.z());
    message.data().insert(message.data().end(), depth.begin(), depth.end());
  }
  return message;
}

}  // namespace thalweg::test
