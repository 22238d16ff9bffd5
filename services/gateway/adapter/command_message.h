#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "common/base/result.h"
#include "common/dds/topics.h"
#include "services/gateway/core/command.h"

namespace thalweg::gateway {

/// The message for a command that came as JSON, or as CDR bytes; the error says what is wrong with these.
Result<thalweg_msgs::msg::OperatorCommand> ToMessage(
    const std::variant<Command, std::vector<std::uint8_t>>& content);

/// The same for a command to a replay.
/// @param begin  Log time of the recording's beginning.
Result<thalweg_msgs::msg::ReplayCommand> ToReplayMessage(
    const std::variant<Command, std::vector<std::uint8_t>>& content, Time begin);

/// In one line, for the log, e.g. "goto (1.00, 2.00, 1.20)".
std::string Described(const thalweg_msgs::msg::OperatorCommand& command);
std::string Described(const thalweg_msgs::msg::ReplayCommand& command);

}  // namespace thalweg::gateway
