#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace thalweg::gateway {

/// In the order of CommandKind in thalweg_msgs.
enum class CommandKind : std::uint8_t {
  kPause,
  kResume,
  kStep,
  kStop,
  kHome,
  kGoTo,
  kLookAt,
  kIgnoreFrontier,
  kNoGoBox,
  kClearNoGo,
  kStrategy,
  kSaveMap,
};

/// The only parameter that may change while the run goes on, by the command "strategy".
inline constexpr std::string_view kStrategyParameter = "explorer.strategy";

/// What a client wants of the robot. Its meaning, and what is refused, is decided by the explorer and the
/// mapper.
struct Command {
  CommandKind kind = CommandKind::kPause;
  std::array<double, 3> point = {};   ///< [m] map
  std::array<double, 3> corner = {};  ///< [m] map
  double yaw_rad = std::numeric_limits<double>::quiet_NaN();
  std::string strategy;
};

/// A command as a service that clients call, e.g. /operator/goto.
struct CommandService {
  std::string_view name;  ///< Without "/operator/"; in JSON the command's kind.
  CommandKind kind;
  std::string_view help;
  bool point = false;  ///< Whether the request must have this member; likewise the next three.
  bool corner = false;
  bool yaw = false;  ///< May have.
  bool strategy = false;
};
/// All of them; service n has the id n + 1.
std::span<const CommandService> CommandServices();
std::string NameOf(const CommandService& service);  ///< "/operator/goto"

/// Reads the request of a service, e.g. {"point": {"x": 1, "y": 2, "z": 1.2}}. Empty text is an empty
/// request. The error names the member that is wrong, and what it must be.
Result<Command> ParseRequest(const CommandService& service, std::string_view json);
/// Reads the value, in JSON, that kStrategyParameter is to have.
Result<Command> ParseStrategy(std::string_view json);
/// Reads a message on operator/command: the members of the service's request, and "kind", which is a name
/// such as "goto" or a number of CommandKind.
Result<Command> ParseCommand(std::string_view json);

// JSON Schemas of these, and of the reply to both: {"accepted": true, "service": "explorer", "reason": "..."}
std::string RequestSchema(const CommandService& service);
std::string ReplySchema();

/// The answer to a command.
struct CommandAnswer {
  bool accepted = false;
  std::string service;  ///< explorer or mapper; gateway, if the command did not reach them.
  std::string reason;   ///< What happens now, or why not.
};
std::string ToJson(const CommandAnswer& answer);

}  // namespace thalweg::gateway
