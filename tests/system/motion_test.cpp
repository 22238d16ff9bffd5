#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>

#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/scenario/scenario.h"
#include "tests/system/processes.h"

namespace thalweg::test {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

/// Simulator and controller as processes; the test takes the role of the explorer.
class MotionSystemTest : public testing::Test {
 protected:
  MotionSystemTest() : bus_(Options(place_)) {
    bus_.Subscribe<topics::Odometry>([this](const auto& message) {
      const auto pose = dds::FromIdl(message);
      ASSERT_TRUE(pose);
      if (robot_ && (pose->T.translation() - robot_->T.translation()).norm() > 1e-6) moved_ = pose->stamp;
      robot_ = *pose;
    });
    bus_.Subscribe<topics::MotionStatus>([this](const auto& message) { motion_ = message; });
    bus_.Subscribe<topics::SimulationStatus>([this](const auto& message) { simulation_ = message; });
    bus_.Every(100ms, [this] {
      if (!path_.T_WBs.empty()) path_out_.Write(dds::ToIdl(path_));
    });
  }

  static dds::BusOptions Options(const OwnPlace& place) {
    dds::BusOptions options = place.BusOptions();
    options.clock = dds::ClockSource::kTopic;
    return options;
  }
  std::unique_ptr<RunningProgram> Start(const std::string& service) const {
    return std::make_unique<RunningProgram>(
        "thalweg-" + service,
        std::vector<std::string>{"--scenario", "tiny", "--set", "simulator.time_scale=2", "--out",
                                 place_.folder()},
        place_.folder() / (service + ".log"));
  }
  /// The files of this domain's ports in shared memory, of those that are not numbered as UDP's.
  std::set<std::string> Ports() const {
    std::set<std::string> ports;
    const std::regex of_domain("fastrtps_port" + std::to_string(place_.domain() + 1) + "[0-9]{7}");
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
      std::string name = entry.path().filename().string();
      if (std::regex_match(name, of_domain)) ports.insert(std::move(name));
    }
    return ports;
  }
  bool Until(const std::function<bool()>& done) { return bus_.SpinUntil(done, 30s); }
  void Follow(std::vector<RigidTransform> poses) { path_ = {.stamp = bus_.Now(), .T_WBs = std::move(poses)}; }
  RigidTransform Beside(double x, double y, double yaw) const {
    return MakeTransform(RotationFromYawPitch(yaw, 0.0),
                         robot_->T.translation() + Eigen::Vector3d(x, y, 0.0));
  }
  bool Is(thalweg_msgs::msg::MotionState state) const { return motion_ && motion_->state() == state; }

  OwnPlace place_;
  dds::Bus bus_;
  dds::Bus::Publisher<topics::Path> path_out_ = bus_.Advertise<topics::Path>();
  dds::StampedPath path_;
  std::optional<dds::StampedPose> robot_;
  Time moved_;
  std::optional<thalweg_msgs::msg::MotionStatus> motion_;
  std::optional<thalweg_msgs::msg::SimulationStatus> simulation_;
};

TEST_F(MotionSystemTest, ControllerLeadsTheSimulatedRobotAlongThePathWithoutCollision) {
  const auto simulator = Start("simulator");
  const auto controller = Start("controller");
  ASSERT_TRUE(Until([&] { return robot_ && motion_; }));
  const RigidTransform end = Beside(-0.3, 0.3, 2.0);
  Follow({Beside(0, 0, 0), Beside(0, 0.3, 1.0), end});
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_DONE); }));
  EXPECT_LT((robot_->T.translation() - end.translation()).norm(), 0.031);
  EXPECT_LT(AngleBetween(robot_->T, end), 0.051);
  ASSERT_TRUE(Until([&] { return simulation_ && simulation_->distance_m() > 0.5; }));
  EXPECT_EQ(simulation_->true_collisions(), 0U);
}

TEST_F(MotionSystemTest, AServiceThatFollowsAKilledOneTakesNoneOfItsPorts) {
  const auto simulator = Start("simulator");
  auto controller = Start("controller");
  ASSERT_TRUE(Until([&] { return robot_ && motion_; }));
  const std::set<std::string> before = Ports();
  EXPECT_GE(before.size(), 6U) << "two each of this process, simulator and controller, and what others left";
  controller->Kill(SIGKILL);
  controller->WaitForEnd(10s);
  controller = Start("controller");
  const auto new_ports = [&] {
    const std::set<std::string> now = Ports();
    return std::ranges::count_if(now, [&](const std::string& port) { return before.count(port) == 0; });
  };
  EXPECT_TRUE(Until([&] { return new_ports() == 2; }));
}

TEST_F(MotionSystemTest, RobotStandsWithinASecondWhenTheControllerIsKilledAndGoesOnWithAnother) {
  const auto simulator = Start("simulator");
  auto controller = Start("controller");
  ASSERT_TRUE(Until([&] { return robot_ && motion_; }));
  const RigidTransform end = Beside(-0.3, -0.5, 0.0);
  Follow({Beside(0, 0, 0), Beside(0, -0.5, 0.0), end});
  ASSERT_TRUE(Until([&] { return motion_->distance_done_m() > 0.1; }));
  const Time killed = bus_.Now();
  controller->Kill(SIGKILL);
  ASSERT_TRUE(Until([&] { return bus_.Now() - killed > 3s; }));
  EXPECT_GT(moved_ - killed, -1s);
  EXPECT_LT(moved_ - killed, 1s);
  EXPECT_GT((robot_->T.translation() - end.translation()).norm(), 0.1);

  motion_.reset();
  controller = Start("controller");
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::MOTION_DONE); }));
  EXPECT_LT((robot_->T.translation() - end.translation()).norm(), 0.031);
}

TEST_F(MotionSystemTest, RobotThatMeetsAWallIsReportedAsBlocked) {
  const auto simulator = Start("simulator");
  const auto controller = Start("controller");
  ASSERT_TRUE(Until([&] { return robot_ && motion_; }));
  Follow({Beside(0, 0, 0), Beside(-2.0, 0, 0)});  // a path through the wall
  ASSERT_TRUE(Until([&] {
    return Is(thalweg_msgs::msg::MOTION_STOPPED) && motion_->reason().find("blocked") != std::string::npos;
  }));
  EXPECT_GT(robot_->T.translation().x(), 0.1);
}

}  // namespace
}  // namespace thalweg::test
