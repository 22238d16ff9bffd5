#pragma once

#include <string_view>

namespace thalweg::inspector {

/// The message types of ROS 2 Humble's packages for sensors, robots and tools, as Definitions takes them:
/// what is on the wire, without the constants. Their layouts are ROS 2's common interfaces
/// [https://github.com/ros2/common_interfaces, rcl_interfaces, geometry2]; a test compares them with another
/// implementation's.
std::string_view StandardTypes();

}  // namespace thalweg::inspector
