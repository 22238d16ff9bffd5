#pragma once

#include <string>
#include <string_view>

namespace thalweg::dds {

/// The hash that differs between definitions of a type in ROS 2 (from Iron on) [REP 2016]: "RIHS01_" and the
/// SHA-256 of its description.
/// @param wire_type  As the type is registered, e.g. sensor_msgs::msg::dds_::PointCloud2_.
/// @return           Empty for a type that ROS 2 cannot describe.
std::string TypeHash(std::string_view wire_type);

}  // namespace thalweg::dds
