#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace thalweg::inspector {

/// The folders that hold PACKAGE/msg/NAME.msg: those of THALWEG_MSG_PATH (separated by colons), the share/
/// folders of AMENT_PREFIX_PATH, and /opt/ros/*/share, in this order, so that nothing needs to be sourced.
std::vector<std::filesystem::path> MessageFolders();

/// The definition of a message type, as Schema::Parse takes it: from idl/, from ROS 2's standard packages
/// (StandardTypes), or from a .msg file.
/// @param type  "sensor_msgs/msg/Imu".
/// Fails, saying where it was looked for, for a type that is defined nowhere.
Result<std::string> MessageDefinition(std::string_view type,
                                      const std::vector<std::filesystem::path>& folders);

}  // namespace thalweg::inspector
