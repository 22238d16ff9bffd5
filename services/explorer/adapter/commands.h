#pragma once

#include <thalweg_msgs.h>

#include "common/base/result.h"
#include "services/explorer/core/command.h"

namespace thalweg::explorer {

/// Checks a command and converts it. Error: another frame than the map's, an unknown kind, a coordinate in
/// use that is not finite or beyond 1 km, a box that is not ordered, a strategy's name of more than 64
/// characters; or a kind that is not for the explorer.
Result<Command> CommandFrom(const thalweg_msgs::msg::OperatorCommand& message);

}  // namespace thalweg::explorer
