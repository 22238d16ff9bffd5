#include "common/dds/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "common/dds/convert.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using test::AwaitMatch;
using test::BusOptionsForTest;
using test::kPatience;
using testing::HasSubstr;

const Time kAnyStamp{std::chrono::seconds(7)};

Names Scout() {
  Names names;
  names.robot = "scout";
  return names;
}

BusOptions OptionsWith(const std::string& participant, Names names) {
  BusOptions options = BusOptionsForTest(participant);
  options.names = std::move(names);
  return options;
}

nav_msgs::msg::Odometry OdometryAt(double x) {
  return OdometryToIdl(kAnyStamp, MakeTransform(Eigen::Matrix3d::Identity(), {x, 0, 0}), {0, 0, 0},
                       {0, 0, 0});
}

TEST(Names, WithoutAnythingSaidEachIsCalledAsInTheTable) {
  const Names names;
  EXPECT_EQ(names.Topic(topics::DepthPoints::kName), topics::DepthPoints::kName);
  for (const char* frame : {kMapFrame, kOdometryFrame, kBodyFrame, kCameraFrame}) {
    EXPECT_EQ(names.Frame(frame), frame);
    EXPECT_EQ(names.OwnFrame(frame), frame);
  }
  EXPECT_NO_THROW(names.Check());
}

TEST(Names, OfARobotPrecedeRelativeTopicsAndAllFrames) {
  Names names = Scout();
  names.topics[topics::DepthPoints::kName] = "camera/points";
  names.topics[topics::Clock::kName] = "/clock";
  names.frames.camera = "lens";
  EXPECT_EQ(names.Topic(topics::DepthPoints::kName), "scout/camera/points");
  EXPECT_EQ(names.Topic(topics::Clock::kName), "clock");
  EXPECT_EQ(names.Topic("vicon/pose"), "scout/vicon/pose");
  EXPECT_EQ(names.Frame(kCameraFrame), "scout/lens");
  EXPECT_EQ(names.OwnFrame("scout/lens"), kCameraFrame);
  EXPECT_EQ(names.OwnFrame(kCameraFrame), std::nullopt);
  EXPECT_EQ(names.Frame("camera_link"), "camera_link") << "none of ours";
}

TEST(Names, ThatTwoTopicsOrTwoFramesWouldShareAreRefused) {
  Names topics;
  topics.topics[topics::DepthPoints::kName] = topics::Odometry::kName;
  EXPECT_THROW(topics.Check(), std::runtime_error);
  EXPECT_THROW(Bus(OptionsWith("mapper", topics)), std::runtime_error);
  Names frames;
  frames.frames.camera = kBodyFrame;
  EXPECT_THROW(frames.Check(), std::runtime_error);
  Names absolute = Scout();  // scout/odometry, twice
  absolute.topics[topics::DepthPoints::kName] = std::string("/scout/") + topics::Odometry::kName;
  EXPECT_THROW(absolute.Check(), std::runtime_error);
}

TEST(Names, AreFoundInEachMessageThatHasFrames) {
  const auto count = [](auto message) {
    int frames = 0;
    ForEachFrame(message, [&](std::string&) { ++frames; });
    return frames;
  };
  EXPECT_EQ(count(OdometryAt(0)), 2);
  EXPECT_EQ(count(ToIdl(StampedPath{kAnyStamp, {RigidTransform::Identity(), RigidTransform::Identity()}})),
            3);
  EXPECT_EQ(count(TransformsToIdl(kAnyStamp, RigidTransform::Identity(), RigidTransform::Identity())), 6);
  EXPECT_EQ(count(stereo_msgs::msg::DisparityImage()), 2);
  EXPECT_EQ(count(geometry_msgs::msg::Twist()), 0);
  visualization_msgs::msg::MarkerArray markers;
  markers.markers().resize(3);
  EXPECT_EQ(count(markers), 3);
}

TEST(Names, OfTwoRobotsKeepThemApartOnOneNetwork) {
  Names rover;
  rover.robot = "rover";
  Bus scout_out(OptionsWith("scout", Scout()));
  Bus rover_out(OptionsWith("rover", rover));
  Bus scout_in(OptionsWith("scout listener", Scout()));
  const auto scout = scout_out.Advertise<topics::Odometry>();
  const auto other = rover_out.Advertise<topics::Odometry>();
  std::vector<double> heard;
  scout_in.Subscribe<topics::Odometry>([&](const auto& message) {
    const auto pose = FromIdl(message);
    ASSERT_TRUE(pose) << pose.error();
    heard.push_back(pose->T.translation().x());
  });
  AwaitMatch(scout_out, scout, scout_in);
  other.Write(OdometryAt(2.0));
  scout.Write(OdometryAt(1.0));
  ASSERT_TRUE(scout_in.SpinUntil([&] { return !heard.empty(); }, kPatience));
  EXPECT_EQ(heard, std::vector<double>{1.0});
  EXPECT_EQ(other.readers(), 0);
}

TEST(Names, OfTopicsAndFramesAreThoseOfTheWire) {
  Names names = Scout();
  names.topics[topics::Odometry::kName] = "wheels";
  Bus robot(OptionsWith("robot", names));
  const auto out = robot.Advertise<topics::Odometry>();
  Bus listener(BusOptionsForTest("listener"));  // of another system: no names
  std::optional<nav_msgs::msg::Odometry> heard;
  listener.SubscribeTo<topics::Odometry>("scout/wheels", [&](const auto& message) { heard = message; });
  ASSERT_TRUE(robot.SpinUntil([&] { return out.readers() > 0; }, kPatience));
  robot.EveryWall(std::chrono::milliseconds(20), [&] { out.Write(OdometryAt(1.0)); });
  ASSERT_TRUE(robot.SpinUntil(
      [&] { return listener.SpinUntil([&] { return heard.has_value(); }, std::chrono::milliseconds(5)); },
      kPatience));
  EXPECT_EQ(heard->header().frame_id(), "scout/odom");
  EXPECT_EQ(heard->child_frame_id(), "scout/base_link");
}

TEST(Names, OfOthersFramesAreRefusedByTheNamesThatTheScenarioGives) {
  nav_msgs::msg::Odometry odometry = OdometryAt(1.0);
  const auto problem = ToOwnFrames(Scout(), odometry);
  ASSERT_TRUE(problem);
  EXPECT_THAT(*problem, HasSubstr("must be one of the scenario's frames, \"scout/map\", \"scout/odom\""));
  nav_msgs::msg::Odometry own = OdometryAt(1.0);
  ToWireFrames(Scout(), own);
  EXPECT_EQ(own.header().frame_id(), "scout/odom");
  EXPECT_EQ(ToOwnFrames(Scout(), own), std::nullopt);
  EXPECT_EQ(own, OdometryAt(1.0));
}

}  // namespace
}  // namespace thalweg::dds
