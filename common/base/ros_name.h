#pragma once

#include <string_view>

namespace thalweg {

/// Whether a text is a name of ROS 2 without a leading slash: words of letters, digits and single
/// underscores, none beginning with a digit, separated by single slashes
/// [design.ros2.org/articles/topic_and_service_names.html].
bool IsRosName(std::string_view text);

/// The same for people: "X is not ...".
inline constexpr std::string_view kRosNameRule =
    "a name of ROS 2: words of letters, digits and single underscores, none beginning with a digit, "
    "separated by single slashes";

}  // namespace thalweg
