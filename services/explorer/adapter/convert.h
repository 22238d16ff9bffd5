#pragma once

#include <optional>

#include "common/dds/topics.h"
#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/outcome.h"

namespace thalweg::explorer {

thalweg_msgs::msg::AsideReason ToIdl(AsideReason reason);
/// A value that the message does not define counts as kNone.
AsideReason FromIdl(thalweg_msgs::msg::AsideReason reason);

thalweg_msgs::msg::ExplorationOutcome ToIdl(Outcome outcome);
/// Empty while exploring, for the reason of an outside explorer, and for a value that is not defined.
std::optional<Outcome> FromIdl(thalweg_msgs::msg::ExplorationOutcome outcome);

}  // namespace thalweg::explorer
