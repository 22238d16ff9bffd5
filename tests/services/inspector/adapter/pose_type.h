#pragma once

namespace thalweg::inspector {

/// Type of a stamped pose as it is called on the wire.
inline constexpr auto kPoseType = "geometry_msgs::msg::dds_::PoseStamped_";

}  // namespace thalweg::inspector
