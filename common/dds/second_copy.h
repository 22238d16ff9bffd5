#pragma once

#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/dds/topics.h"

namespace thalweg::dds {

/// Whether the service that sent `mine` is a second copy of the one that sent `other`, and so must end: two
/// mappers, say, would publish two maps on one topic. Of two copies the one that started later ends, and only
/// within the first 10 s of its work, so that what a stranger sends cannot end a service at work. Ages are
/// compared, not times, since the clocks of two machines may differ. Only ask about messages of a participant
/// that exists and has the service's name.
///
/// @param at_work  For how long the service has been handling messages.
/// @return What is wrong, naming the other; nothing if `mine` may go on.
std::optional<std::string> FindSecondCopy(const thalweg_msgs::msg::ServiceHealth& mine,
                                          const thalweg_msgs::msg::ServiceHealth& other, Duration at_work);

}  // namespace thalweg::dds
