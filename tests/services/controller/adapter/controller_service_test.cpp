#include "services/controller/adapter/controller_service.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>

#include "common/dds/convert.h"

namespace thalweg::controller {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

const Eigen::Vector3d kRest = Eigen::Vector3d::Zero();

RigidTransform At(double x) {
  return MakeTransform(Eigen::Matrix3d::Identity(), {x, 0.0, 0.0});
}

dds::BusOptions BusOptionsFor(const char* name) {
  dds::BusOptions options;
  options.name = name;
  options.domain = 61;
  options.partition = "controller-test-" + std::to_string(getpid());
  return options;
}

/// The controller on its own participant and thread.
class RunningController {
 public:
  RunningController() : bus_(BusOptionsFor("controller")), service_({}, bus_) {}
  void Stop() { thread_ = {}; }

 private:
  dds::Bus bus_;
  ControllerService service_;
  std::jthread thread_{[this](std::stop_token stop) { bus_.Spin(stop); }};
};

/// An ideal robot that is always at the commanded pose, and an explorer that repeats its path; both on the
/// system clock.
class ControllerServiceTest : public testing::Test {
 protected:
  ControllerServiceTest() {
    bus_.Subscribe<topics::PoseCommand>([this](const auto& message) {
      const auto pose = dds::FromIdl(message);
      ASSERT_TRUE(pose);
      if ((pose->T.translation() - robot_.translation()).norm() > 1e-9) moved_ = bus_.Now();
      robot_ = pose->T;
      ++commands_;
    });
    bus_.Subscribe<topics::VelocityCommand>([this](const auto& message) { velocity_ = message; });
    bus_.Subscribe<topics::MotionStatus>([this](const auto& message) { status_ = message; });
    bus_.Subscribe<topics::Health>([this](const auto& message) {
      if (message.service() == "controller") health_ = message;
    });
    bus_.Every(20ms, [this] {
      if (!pose_silent_) odometry_out_.Write(dds::OdometryToIdl(bus_.Now(), robot_, kRest, kRest));
    });
    bus_.Every(100ms, [this] {
      if (path_silent_ || !path_) return;
      path_out_.Write(dds::ToIdl(*path_));
      heard_ = bus_.Now();
    });
  }

  bool Until(const std::function<bool()>& done) { return bus_.SpinUntil(done, 10s); }
  bool Matched() const {
    return path_out_.readers() == 1 && odometry_out_.readers() == 1 &&
           bus_.Writers<topics::PoseCommand>() == 1 && bus_.Writers<topics::MotionStatus>() == 1;
  }
  void Follow(std::vector<RigidTransform> poses) {
    path_ = dds::StampedPath{.stamp = bus_.Now(), .T_WBs = std::move(poses)};
  }
  bool Is(thalweg_msgs::msg::MotionState state) const { return status_ && status_->state() == state; }

  dds::Bus bus_{BusOptionsFor("test")};
  dds::Bus::Publisher<topics::Path> path_out_ = bus_.Advertise<topics::Path>();
  dds::Bus::Publisher<topics::Odometry> odometry_out_ = bus_.Advertise<topics::Odometry>();
  RigidTransform robot_ = At(0.0);
  Time moved_;
  Time heard_;
  int commands_ = 0;
  bool path_silent_ = false;
  bool pose_silent_ = false;
  std::optional<dds::StampedPath> path_;
  std::optional<geometry_msgs::msg::Twist> velocity_;
  std::optional<thalweg_msgs::msg::MotionStatus> status_;
  std::optional<thalweg_msgs::msg::ServiceHealth> health_;  ///< The controller's.
};

TEST_F(ControllerServiceTest, LeadsTheRobotToTheEndOfThePath) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_IDLE); }));
  EXPECT_EQ(commands_, 0);
  Follow({At(0.0), At(0.5)});
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_FOLLOWING) && status_->speed_mps() > 0.1; }));
  EXPECT_GT(velocity_->linear().x(), 0.0);
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_DONE); }));
  EXPECT_NEAR(robot_.translation().x(), 0.5, 0.03);
  EXPECT_NEAR(status_->distance_done_m(), 0.5, 0.01);
  EXPECT_EQ(status_->path_stamp(), dds::ToIdl(path_->stamp));
}

TEST_F(ControllerServiceTest, CommandsTheSameVelocitiesWithAndWithoutAStamp) {
  std::vector<geometry_msgs::msg::Twist> plain;
  std::vector<geometry_msgs::msg::TwistStamped> stamped;
  bus_.Subscribe<topics::StampedVelocityCommand>([&](const auto& message) { stamped.push_back(message); });
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched() && bus_.Writers<topics::StampedVelocityCommand>() == 1; }));
  Follow({At(0.0), At(0.5)});
  ASSERT_TRUE(Until([&] {
    if (velocity_ && (plain.empty() || !(plain.back() == *velocity_))) plain.push_back(*velocity_);
    return Is(thalweg_msgs::msg::MOTION_DONE);
  }));
  ASSERT_GT(stamped.size(), 10U);
  EXPECT_EQ(stamped.back().header().frame_id(), "base_link");
  for (std::size_t n = 1; n < stamped.size(); ++n) {
    EXPECT_GT(*dds::FromIdl(stamped[n].header().stamp()), *dds::FromIdl(stamped[n - 1].header().stamp()));
  }
  // A busy machine may miss some of either
  const auto both = std::ranges::count_if(plain, [&](const auto& twist) {
    return std::ranges::any_of(stamped, [&](const auto& of) { return of.twist() == twist; });
  });
  EXPECT_GT(both, std::ssize(plain) / 2);
}

TEST_F(ControllerServiceTest, SaysTheMotionToComeWhileSomebodyListens) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  std::vector<trajectory_msgs::msg::MultiDOFJointTrajectory> heard;
  bus_.Subscribe<topics::Trajectory>([&](const auto& message) { heard.push_back(message); });
  ASSERT_TRUE(Until([&] { return bus_.Writers<topics::Trajectory>() == 1; }));
  Follow({At(0.0), At(2.0)});
  ASSERT_TRUE(Until([&] { return robot_.translation().x() > 0.5 && heard.size() > 3; }));
  const trajectory_msgs::msg::MultiDOFJointTrajectory message = heard.back();
  const Time begin = *dds::FromIdl(message.header().stamp());
  ASSERT_GT(message.points().size(), 10U);
  EXPECT_NEAR(message.points().back().transforms()[0].translation().x(), 2.0, 1e-6) << "ends with the path";
  EXPECT_EQ(message.points().back().velocities()[0].linear().x(), 0.0);
  // The robot then does as it was said.
  const std::size_t n = 10;
  const Time then = begin + std::chrono::milliseconds(1000);
  EXPECT_EQ(message.points()[n].time_from_start().sec(), 1);
  ASSERT_TRUE(Until([&] { return bus_.Now() >= then; }));
  EXPECT_NEAR(robot_.translation().x(), message.points()[n].transforms()[0].translation().x(), 0.1);
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_DONE); }));
  heard.clear();
  ASSERT_TRUE(Until([&] { return heard.size() > 1; }));
  EXPECT_EQ(heard.back().points().size(), 1U) << "it stands";
}

TEST_F(ControllerServiceTest, StandsWithinHalfASecondWhenThePathFallsSilent) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  Follow({At(0.0), At(5.0)});
  ASSERT_TRUE(Until([&] { return robot_.translation().x() > 0.3; }));
  path_silent_ = true;
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_STOPPED) && status_->speed_mps() == 0.0; }));
  EXPECT_EQ(status_->stop_reason(), thalweg_msgs::msg::STOP_PATH_SILENT);
  EXPECT_EQ(status_->reason(), "path silent");
  EXPECT_LT(Seconds(moved_ - heard_), 0.5);
  path_silent_ = false;
  const double stood_at = robot_.translation().x();
  EXPECT_TRUE(Until([&] { return robot_.translation().x() > stood_at + 0.1; }));
}

TEST_F(ControllerServiceTest, StandsWhenThePoseFallsSilent) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  Follow({At(0.0), At(5.0)});
  ASSERT_TRUE(Until([&] { return robot_.translation().x() > 0.2; }));
  pose_silent_ = true;
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_STOPPED) && status_->speed_mps() == 0.0; }));
  EXPECT_EQ(status_->stop_reason(), thalweg_msgs::msg::STOP_POSE_SILENT);
  EXPECT_EQ(status_->reason(), "pose silent");
}

TEST_F(ControllerServiceTest, AnOdometryThatJumpsIsDroppedAndTheRobotStands) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  Follow({At(0.0), At(5.0)});
  ASSERT_TRUE(Until([&] { return robot_.translation().x() > 0.3; }));
  pose_silent_ = true;  // from now on the poses alternate between two places, of which neither is the robot's
  double lie = 50.0;
  bus_.Every(20ms, [&] {
    lie = -lie;
    odometry_out_.Write(dds::OdometryToIdl(bus_.Now(), At(lie), kRest, kRest));
  });
  ASSERT_TRUE(Until([&] { return status_->reason() == "pose silent" && status_->speed_mps() == 0.0; }));
  EXPECT_LT(robot_.translation().x(), 1.0);
  ASSERT_TRUE(Until([&] { return health_ && !health_->dropped().empty(); }));
  EXPECT_NE(health_->dropped()[0].last().find("jumps by"), std::string::npos) << health_->dropped()[0].last();
}

TEST_F(ControllerServiceTest, OdometryOfAnotherClockIsDroppedAndTheRobotStands) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  Follow({At(0.0), At(5.0)});
  ASSERT_TRUE(Until([&] { return robot_.translation().x() > 0.3; }));
  pose_silent_ = true;
  bus_.Every(20ms, [&] { odometry_out_.Write(dds::OdometryToIdl(bus_.Now() + 60s, robot_, kRest, kRest)); });
  ASSERT_TRUE(Until([&] { return status_->reason() == "pose silent" && status_->speed_mps() == 0.0; }));
  EXPECT_LT(robot_.translation().x(), 1.0);
  ASSERT_TRUE(Until([&] { return health_ && !health_->dropped().empty(); }));
  EXPECT_NE(health_->dropped()[0].last().find("60 s ahead of the clock"), std::string::npos);
}

TEST_F(ControllerServiceTest, AnotherControllerTakesOverInTheMiddleOfThePath) {
  auto first = std::make_unique<RunningController>();
  ASSERT_TRUE(Until([&] { return Matched(); }));
  Follow({At(0.0), At(0.8)});
  ASSERT_TRUE(Until([&] { return robot_.translation().x() > 0.3; }));
  first.reset();
  const double stood_at = robot_.translation().x();
  RunningController second;
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_DONE); }));
  EXPECT_LT(stood_at, 0.8);
  EXPECT_NEAR(robot_.translation().x(), 0.8, 0.03);
}

TEST_F(ControllerServiceTest, MessagesThatLieAreRefusedAndDoNotMoveTheRobot) {
  RunningController controller;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  nav_msgs::msg::Path lie = dds::ToIdl({.stamp = bus_.Now(), .T_WBs = {At(0.0), At(1.0)}});
  lie.poses()[1].pose().position().x(std::numeric_limits<double>::quiet_NaN());
  nav_msgs::msg::Odometry nowhere = dds::OdometryToIdl(bus_.Now(), At(0.0), kRest, kRest);
  nowhere.pose().pose().orientation().w(0.0);
  bus_.Every(50ms, [&] {
    path_out_.Write(lie);
    odometry_out_.Write(nowhere);
  });
  ASSERT_TRUE(Until([&] { return health_ && health_->rejected().size() == 2; }));
  EXPECT_EQ(commands_, 0);
  EXPECT_TRUE(Is(thalweg_msgs::msg::MOTION_IDLE));
}

}  // namespace
}  // namespace thalweg::controller
