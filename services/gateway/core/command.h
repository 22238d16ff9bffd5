#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "common/base/result.h"
#include "common/base/time.h"

namespace thalweg::gateway {

/// Those of CommandKind in thalweg_msgs, then those of ReplayCommandKind, in the same order.
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
  kReplayPause,
  kReplayResume,
  kReplaySeek,
  kReplayRate,
};

/// Whom commands are for, and so on which topic they are published.
enum class CommandGroup : std::uint8_t {
  kOperator,  ///< The robot, on operator/command.
  kReplay,    ///< A recording that is replayed, on replay/command.
};

/// The only parameter that may change while the run goes on, by the command "strategy".
inline constexpr std::string_view kStrategyParameter = "explorer.strategy";

/// What a client wants of the robot, or of a replay. Its meaning, and what is refused, is decided by the
/// explorer and the mapper, or by the replay.
struct Command {
  CommandKind kind = CommandKind::kPause;
  std::array<double, 3> point = {};   ///< [m] map
  std::array<double, 3> corner = {};  ///< [m] map
  double yaw_rad = std::numeric_limits<double>::quiet_NaN();
  std::string strategy;
  std::variant<Duration, Time> time;  ///< Since the recording's beginning, or its log time.
  double rate = 1.0;                  ///< Seconds of the recording per second.
};

/// A command as a service that clients call, e.g. /operator/goto.
struct CommandService {
  std::string_view name;  ///< Without "/operator/" or "/replay/"; in JSON the command's kind.
  CommandKind kind;
  std::string_view help;
  bool point = false;  ///< Whether the request must have this member; likewise the others.
  bool corner = false;
  bool yaw = false;  ///< May have.
  bool strategy = false;
  bool time = false;  ///< As time_s or time.
  bool rate = false;

  CommandGroup group() const {
    return kind < CommandKind::kReplayPause ? CommandGroup::kOperator : CommandGroup::kReplay;
  }
  /// The kind's number in the messages of its group.
  std::uint64_t number() const {
    const CommandKind first =
        group() == CommandGroup::kOperator ? CommandKind::kPause : CommandKind::kReplayPause;
    return static_cast<std::uint64_t>(kind) - static_cast<std::uint64_t>(first);
  }
};
/// All of them; service n has the id n + 1.
std::span<const CommandService> CommandServices();
std::string NameOf(const CommandService& service);  ///< "/operator/goto"

/// Reads the request of a service, e.g. {"point": {"x": 1, "y": 2, "z": 1.2}}. Empty text is an empty
/// request. The error names the member that is wrong, and what it must be.
Result<Command> ParseRequest(const CommandService& service, std::string_view json);
/// Reads the value, in JSON, that kStrategyParameter is to have.
Result<Command> ParseStrategy(std::string_view json);
/// Reads a message on a group's topic: the members of the service's request, and "kind", which is a name such
/// as "goto" or a number in the messages of the group.
Result<Command> ParseCommand(CommandGroup group, std::string_view json);

// JSON Schemas of these, and of the reply to both: {"accepted": true, "service": "explorer", "reason": "..."}
std::string RequestSchema(const CommandService& service);
std::string ReplySchema();

/// The answer to a command.
struct CommandAnswer {
  bool accepted = false;
  std::string service;  ///< explorer, mapper or replay; gateway, if the command did not reach them.
  std::string reason;   ///< What happens now, or why not.
};
std::string ToJson(const CommandAnswer& answer);

}  // namespace thalweg::gateway
