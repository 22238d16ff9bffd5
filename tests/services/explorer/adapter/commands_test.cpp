#include "services/explorer/adapter/commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "common/dds/convert.h"

namespace thalweg::explorer {
namespace {

using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

geometry_msgs::msg::Point Point(double x, double y, double z) {
  geometry_msgs::msg::Point point;
  point.x(x);
  point.y(y);
  point.z(z);
  return point;
}

thalweg_msgs::msg::OperatorCommand Message(thalweg_msgs::msg::CommandKind kind) {
  thalweg_msgs::msg::OperatorCommand message;
  message.header(dds::MakeHeader(Time{}, dds::kMapFrame));
  message.kind(kind);
  message.point(Point(1.0, 2.0, 3.0));
  message.corner(Point(2.0, 3.0, 4.0));
  message.yaw_rad(kNaN);
  return message;
}

void ExpectRefused(const thalweg_msgs::msg::OperatorCommand& message, const std::string& why) {
  const Result<Command> command = CommandFrom(message);
  ASSERT_FALSE(command);
  EXPECT_THAT(command.error(), HasSubstr(why));
}

TEST(Commands, EveryKindForTheExplorerIsConverted) {
  using namespace thalweg_msgs::msg;
  const auto holds = [](CommandKind kind, std::size_t index) {
    const Result<Command> command = CommandFrom(Message(kind));
    ASSERT_TRUE(command) << command.error();
    EXPECT_EQ(command->index(), index);
  };
  holds(COMMAND_PAUSE, 0);
  holds(COMMAND_RESUME, 1);
  holds(COMMAND_STEP, 2);
  holds(COMMAND_STOP, 3);
  holds(COMMAND_HOME, 4);
  holds(COMMAND_GOTO, 5);
  holds(COMMAND_LOOK_AT, 5);
  holds(COMMAND_IGNORE_FRONTIER, 6);
  holds(COMMAND_NO_GO_BOX, 7);
  holds(COMMAND_CLEAR_NO_GO, 8);
  holds(COMMAND_STRATEGY, 9);
}

TEST(Commands, AGoalKeepsItsPlaceAndItsHeadingWithinATurn) {
  thalweg_msgs::msg::OperatorCommand message = Message(thalweg_msgs::msg::COMMAND_GOTO);
  Errand errand = std::get<command::Run>(*CommandFrom(message)).errand;
  EXPECT_EQ(errand.kind, Errand::Kind::kGoTo);
  EXPECT_EQ(errand.p_W, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_FALSE(errand.yaw_W);
  message.yaw_rad(1.0 + 4.0 * std::numbers::pi);
  errand = std::get<command::Run>(*CommandFrom(message)).errand;
  EXPECT_NEAR(errand.yaw_W.value(), 1.0, 1e-9);
}

TEST(Commands, WhatASenderCanGetWrongIsNamed) {
  using namespace thalweg_msgs::msg;
  OperatorCommand message = Message(COMMAND_PAUSE);
  message.header().frame_id("odom");
  ExpectRefused(message, "frame_id must be map");
  message = Message(static_cast<CommandKind>(77));
  ExpectRefused(message, "kind is 77");
  ExpectRefused(Message(COMMAND_SAVE_MAP), "mapper");
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1000.1, -1e300}) {
    for (const CommandKind kind : {COMMAND_GOTO, COMMAND_LOOK_AT, COMMAND_IGNORE_FRONTIER, COMMAND_NO_GO_BOX}) {
      message = Message(kind);
      message.point().y(bad);
      ExpectRefused(message, "point.y");
    }
    message = Message(COMMAND_NO_GO_BOX);
    message.corner().z(bad);
    ExpectRefused(message, "corner.z");
  }
  message = Message(COMMAND_NO_GO_BOX);
  message.corner().x(1.0);
  ExpectRefused(message, "below corner");
  message = Message(COMMAND_GOTO);
  message.yaw_rad(kInfinity);
  ExpectRefused(message, "yaw_rad");
  message = Message(COMMAND_STRATEGY);
  message.strategy(std::string(65, 'a'));
  ExpectRefused(message, "64 characters");
}

TEST(Commands, FieldsThatAKindDoesNotUseAreNotChecked) {
  thalweg_msgs::msg::OperatorCommand message = Message(thalweg_msgs::msg::COMMAND_PAUSE);
  message.point(Point(kNaN, kNaN, kNaN));
  message.yaw_rad(kInfinity);
  EXPECT_TRUE(CommandFrom(message));
}

}  // namespace
}  // namespace thalweg::explorer
