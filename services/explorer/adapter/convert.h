#pragma once

#include "common/dds/topics.h"
#include "services/explorer/core/map/look_memory.h"

namespace thalweg::explorer {

thalweg_msgs::msg::AsideReason ToIdl(AsideReason reason);
/// A value that the message does not define counts as kNone.
AsideReason FromIdl(thalweg_msgs::msg::AsideReason reason);

}  // namespace thalweg::explorer
