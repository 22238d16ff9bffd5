#pragma once

#include <optional>
#include <utility>
#include <variant>

#include "common/base/stamp_pairs.h"
#include "common/dds/bus.h"
#include "common/dds/convert.h"

namespace thalweg::dds {

/// Depth images as clouds: pairs each image with the calibration of the same stamp, in whichever order they
/// arrive. What is refused, or has no counterpart, is counted in the health of the bus.
///
/// Threading: that of the bus.
class DepthImages {
 public:
  struct Cloud {
    StampedCloud stamped;
    PinholeCamera camera;  ///< The one that took the image.
  };

  /// @param infinity  What the sensor means by a depth of +infinity.
  DepthImages(Bus& bus, Infinity infinity) : bus_(bus), infinity_(infinity) {}

  /// @return The cloud, if the other half is there already.
  std::optional<Cloud> Add(const sensor_msgs::msg::Image& message);
  std::optional<Cloud> Add(const sensor_msgs::msg::CameraInfo& message);

 private:
  using Half = std::variant<DepthImage, PinholeCamera>;
  std::optional<Cloud> Add(Time stamp, Half half);

  Bus& bus_;
  Infinity infinity_;
  StampPairs<Half> halves_;
};

}  // namespace thalweg::dds
