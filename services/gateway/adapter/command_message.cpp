#include "services/gateway/adapter/command_message.h"

#include <algorithm>
#include <optional>
#include <type_traits>

#include "common/base/text.h"
#include "common/dds/convert.h"
#include "common/dds/topic_table.h"
#include "common/geometry/point_text.h"

namespace thalweg::gateway {
namespace {

using thalweg_msgs::msg::OperatorCommand;
using thalweg_msgs::msg::ReplayCommand;

static_assert(static_cast<int>(CommandKind::kReplayRate) - static_cast<int>(CommandKind::kReplayPause) ==
              thalweg_msgs::msg::REPLAY_RATE);

static_assert(static_cast<int>(CommandKind::kPause) == thalweg_msgs::msg::COMMAND_PAUSE);
static_assert(static_cast<int>(CommandKind::kGoTo) == thalweg_msgs::msg::COMMAND_GOTO);
static_assert(static_cast<int>(CommandKind::kNoGoBox) == thalweg_msgs::msg::COMMAND_NO_GO_BOX);
static_assert(static_cast<int>(CommandKind::kSaveMap) == thalweg_msgs::msg::COMMAND_SAVE_MAP);

geometry_msgs::msg::Point PointFrom(const std::array<double, 3>& values) {
  geometry_msgs::msg::Point point;
  point.x(values[0]);
  point.y(values[1]);
  point.z(values[2]);
  return point;
}

OperatorCommand From(const Command& command) {
  OperatorCommand message;
  message.kind(static_cast<thalweg_msgs::msg::CommandKind>(command.kind));
  message.point(PointFrom(command.point));
  message.corner(PointFrom(command.corner));
  message.yaw_rad(command.yaw_rad);
  message.strategy(command.strategy);
  return message;
}

ReplayCommand ReplayFrom(const Command& command, Time begin) {
  ReplayCommand message;
  message.kind(static_cast<thalweg_msgs::msg::ReplayCommandKind>(
      static_cast<int>(command.kind) - static_cast<int>(CommandKind::kReplayPause)));
  const auto* const since_begin = std::get_if<Duration>(&command.time);
  message.time(dds::ToIdl(since_begin != nullptr ? begin + *since_begin : std::get<Time>(command.time)));
  message.rate(command.rate);
  return message;
}

/// The service of a kind, as messages number it; null if there is none.
const CommandService* ServiceOf(CommandGroup group, std::uint64_t number) {
  const auto services = CommandServices();
  const auto service = std::ranges::find_if(
      services, [&](const CommandService& each) { return each.group() == group && each.number() == number; });
  return service == services.end() ? nullptr : &*service;
}

std::string Text(const geometry_msgs::msg::Point& point) {
  return PointText({point.x(), point.y(), point.z()});
}

}  // namespace

Result<OperatorCommand> ToMessage(const std::variant<Command, std::vector<std::uint8_t>>& content) {
  if (const auto* const command = std::get_if<Command>(&content)) return From(*command);
  const auto& bytes = std::get<std::vector<std::uint8_t>>(content);
  std::optional<OperatorCommand> message = dds::Decode<dds::topics::OperatorCommands>(bytes);
  if (!message) return Error{"the bytes are no thalweg_msgs/msg/OperatorCommand in CDR"};
  if (message->strategy().size() > kLongestName)
    return Error{"the strategy's name has more than 64 characters"};
  return *message;
}

Result<ReplayCommand> ToReplayMessage(const std::variant<Command, std::vector<std::uint8_t>>& content,
                                      Time begin) {
  if (const auto* const command = std::get_if<Command>(&content)) return ReplayFrom(*command, begin);
  std::optional<ReplayCommand> message =
      dds::Decode<dds::topics::ReplayCommands>(std::get<std::vector<std::uint8_t>>(content));
  if (!message) return Error{"the bytes are no thalweg_msgs/msg/ReplayCommand in CDR"};
  return *message;
}

std::string Described(const ReplayCommand& command) {
  const auto kind = static_cast<std::uint64_t>(command.kind());
  const CommandService* const service = ServiceOf(CommandGroup::kReplay, kind);
  if (service == nullptr) return "a command of the unknown kind " + std::to_string(kind);
  std::string text("replay ");
  text += service->name;
  if (service->time) text.append(" to log time ").append(std::to_string(command.time().sec())).append(" s");
  if (service->rate) text.append(" ").append(NumberText(command.rate()));
  return text;
}

std::string Described(const OperatorCommand& command) {
  const auto kind = static_cast<std::uint64_t>(command.kind());
  const CommandService* const service = ServiceOf(CommandGroup::kOperator, kind);
  if (service == nullptr) return "a command of the unknown kind " + std::to_string(kind);
  std::string text(service->name);
  if (service->point) text.append(" ").append(Text(command.point()));
  if (service->corner) text.append(" to ").append(Text(command.corner()));
  if (service->strategy) text.append(" ").append(CleanText(command.strategy()));
  return text;
}

}  // namespace thalweg::gateway
