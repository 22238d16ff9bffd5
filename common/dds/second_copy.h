#pragma once

#include <optional>
#include <string>

#include "common/dds/topics.h"

namespace thalweg::dds {

/// Whether the service that sent `mine` is a second copy of the one that sent `other`, and so must end: two
/// mappers, say, would publish two maps on one topic. Of two copies the one that started later ends, and only
/// within its first 10 s, so that what a stranger sends cannot end a service at work. Ages are compared, not
/// times, since the clocks of two machines may differ.
///
/// @return What is wrong, naming the other; nothing if `mine` may go on.
std::optional<std::string> FindSecondCopy(const thalweg_msgs::msg::ServiceHealth& mine,
                                          const thalweg_msgs::msg::ServiceHealth& other);

}  // namespace thalweg::dds
