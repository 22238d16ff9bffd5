#include "services/gateway/adapter/command_message.h"

#include <algorithm>
#include <optional>
#include <type_traits>

#include "common/base/text.h"
#include "common/dds/topic_table.h"
#include "common/geometry/point_text.h"

namespace thalweg::gateway {
namespace {

using thalweg_msgs::msg::OperatorCommand;

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

std::string Described(const OperatorCommand& command) {
  const auto services = CommandServices();
  const auto kind = static_cast<std::size_t>(command.kind());
  const auto service = std::ranges::find_if(
      services, [&](const CommandService& each) { return static_cast<std::size_t>(each.kind) == kind; });
  if (service == services.end()) return "a command of the unknown kind " + std::to_string(kind);
  std::string text(service->name);
  if (service->point) text.append(" ").append(Text(command.point()));
  if (service->corner) text.append(" to ").append(Text(command.corner()));
  if (service->strategy) text.append(" ").append(CleanText(command.strategy()));
  return text;
}

}  // namespace thalweg::gateway
