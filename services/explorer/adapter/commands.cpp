#include "services/explorer/adapter/commands.h"

#include <cmath>
#include <numbers>
#include <string>

#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::explorer {
namespace {

constexpr double kFarthest = 1000.0;  // [m] On any axis; no map is larger.

Result<Eigen::Vector3d> CheckedPoint(const geometry_msgs::msg::Point& point, const char* field) {
  const Eigen::Vector3d p_W(point.x(), point.y(), point.z());
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(p_W[axis]) <= kFarthest) continue;  // NaN is not
    return Error{std::string(field) + "." + "xyz"[axis] + " is " + NumberText(p_W[axis]) +
                 ", must be -1000 to 1000 m"};
  }
  return p_W;
}

Result<Command> ErrandFrom(const thalweg_msgs::msg::OperatorCommand& message, Errand::Kind kind) {
  const Result<Eigen::Vector3d> p_W = CheckedPoint(message.point(), "point");
  if (!p_W) return Error{p_W.error()};
  Errand errand{.kind = kind, .p_W = *p_W};
  if (kind == Errand::Kind::kGoTo && !std::isnan(message.yaw_rad())) {
    if (std::isinf(message.yaw_rad())) return Error{"yaw_rad is infinite, must be an angle or NaN"};
    errand.yaw_W = std::remainder(message.yaw_rad(), 2.0 * std::numbers::pi);
  }
  return Command(command::Run{errand});
}

Result<Command> NoGoBoxFrom(const thalweg_msgs::msg::OperatorCommand& message) {
  const Result<Eigen::Vector3d> min_W = CheckedPoint(message.point(), "point");
  if (!min_W) return Error{min_W.error()};
  const Result<Eigen::Vector3d> max_W = CheckedPoint(message.corner(), "corner");
  if (!max_W) return Error{max_W.error()};
  if (!(min_W->array() < max_W->array()).all())
    return Error{"point must lie below corner on every axis: they are the box's least and greatest corner"};
  return Command(command::DrawNoGo{Eigen::AlignedBox3d(*min_W, *max_W)});
}

}  // namespace

Result<Command> CommandFrom(const thalweg_msgs::msg::OperatorCommand& message) {
  if (message.header().frame_id() != dds::kMapFrame) {
    return Error{"frame_id must be " + std::string(dds::kMapFrame)};
  }
  switch (message.kind()) {
    case thalweg_msgs::msg::COMMAND_PAUSE:
      return Command(command::Pause{});
    case thalweg_msgs::msg::COMMAND_RESUME:
      return Command(command::Resume{});
    case thalweg_msgs::msg::COMMAND_STEP:
      return Command(command::Step{});
    case thalweg_msgs::msg::COMMAND_STOP:
      return Command(command::Stop{});
    case thalweg_msgs::msg::COMMAND_HOME:
      return Command(command::GoHome{});
    case thalweg_msgs::msg::COMMAND_GOTO:
      return ErrandFrom(message, Errand::Kind::kGoTo);
    case thalweg_msgs::msg::COMMAND_LOOK_AT:
      return ErrandFrom(message, Errand::Kind::kLookAt);
    case thalweg_msgs::msg::COMMAND_IGNORE_FRONTIER: {
      const Result<Eigen::Vector3d> p_W = CheckedPoint(message.point(), "point");
      if (!p_W) return Error{p_W.error()};
      return Command(command::Ignore{*p_W});
    }
    case thalweg_msgs::msg::COMMAND_NO_GO_BOX:
      return NoGoBoxFrom(message);
    case thalweg_msgs::msg::COMMAND_CLEAR_NO_GO:
      return Command(command::ClearNoGo{});
    case thalweg_msgs::msg::COMMAND_STRATEGY:
      if (message.strategy().size() > kLongestName)
        return Error{"the strategy's name has more than 64 characters"};
      return Command(command::UseStrategy{message.strategy()});
    case thalweg_msgs::msg::COMMAND_SAVE_MAP:
      return Error{"saving the map is for the mapper"};
  }
  return Error{"kind is " + std::to_string(static_cast<int>(message.kind())) + ", which is no command"};
}

}  // namespace thalweg::explorer
