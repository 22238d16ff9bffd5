#pragma once

#include <string>
#include <string_view>

namespace thalweg::dds {

// Generated from idl/ by common/dds/schema_generator, for tools that decode messages whose types they do not
// know: Foxglove, rosbag2, PlotJuggler.

/// The definition of a message type and of all types it contains, in the form "ros2msg" of MCAP and of the
/// Foxglove WebSocket protocol [https://mcap.dev/spec/registry]. An enum becomes constants and a uint32.
/// @param type  As Ros2TypeName returns it.
/// @return      Empty if idl/ does not define the type.
std::string_view Ros2MsgSchema(std::string_view type);

/// The description of a message type whose SHA-256 is its type hash [REP 2016], as JSON.
/// @param type  As Ros2TypeName returns it.
/// @return      Empty if idl/ does not define the type, or it has an enum, which ROS 2 does not know.
std::string_view TypeDescription(std::string_view type);

/// "sensor_msgs/msg/PointCloud2" for the name on the wire, "sensor_msgs::msg::dds_::PointCloud2_". Another
/// name is returned as it is.
std::string Ros2TypeName(std::string_view wire_name);

/// The reverse of Ros2TypeName.
std::string WireTypeName(std::string_view ros2_name);

}  // namespace thalweg::dds
