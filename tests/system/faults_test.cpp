#include <gtest/gtest.h>

#include "common/dds/convert.h"
#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

using std::chrono_literals::operator""s;

/// A run in which the robot's true position is followed.
class FaultsSystemTest : public RunSystemTest {
 protected:
  FaultsSystemTest() {
    bus_.Subscribe<dds::topics::MotionStatus>([this](const auto& message) { motion_ = message; });
  }
  Eigen::Vector3d Position() const { return dds::FromIdl(simulation_->map_from_body_true())->translation(); }
  bool Says(const std::string& reason) const {
    return motion_ && motion_->reason().find(reason) != std::string::npos;
  }

  std::optional<thalweg_msgs::msg::MotionStatus> motion_;
};

TEST_F(FaultsSystemTest, CutOffFromItsExplorerTheRobotGoesHomeAndLaterCompletesTheExploration) {
  Start({"--set", "controller.on_cut_off=HOME", "--set", "controller.cut_off_after_s=2"});
  ASSERT_TRUE(Until([this] { return simulation_.has_value(); })) << Printed();
  const Eigen::Vector3d start = Position();
  ASSERT_TRUE(Until([&] { return OnTheWay() && (Position() - start).norm() > 0.4; })) << Printed();
  const pid_t explorer = PidOf("explorer");
  kill(explorer, SIGSTOP);
  ASSERT_TRUE(Until([this] { return Says("path silent: went back, waiting where it began"); })) << Printed();
  EXPECT_LT((Position() - start).norm(), 0.1);
  EXPECT_EQ(motion_->state(), thalweg_msgs::msg::MOTION_STOPPED);
  EXPECT_TRUE(Until([this] { return Printed().find("robot stopped: path silent") != std::string::npos; }))
      << Printed();
  kill(explorer, SIGCONT);
  ExpectComplete();
}

TEST_F(FaultsSystemTest, AForgedPathThroughAWallIsRefusedAndHurtsNothing) {
  const auto path_out = bus_.Advertise<dds::topics::Path>();
  Start({"--without", "explorer"});
  std::optional<dds::StampedPath> path;
  bus_.EveryWall(std::chrono::milliseconds(50), [&] {
    if (path) path_out.Write(dds::ToIdl(*path));
  });
  // The room ends at x = 3; the robot looks at that wall from 0.9.
  ASSERT_TRUE(Until([&] { return simulation_ && pids_.contains("mapper") && path_out.readers() > 0; }))
      << Printed();
  const Eigen::Vector3d start = Position();
  const auto to = [&](double x) {
    const Eigen::Vector3d end(x, start.y(), start.z());
    return std::vector{MakeTransform(Eigen::Matrix3d::Identity(), start),
                       MakeTransform(Eigen::Matrix3d::Identity(), end)};
  };
  path = dds::StampedPath{.stamp = Time{} + 1s, .T_WBs = to(6.0)};
  ASSERT_TRUE(Until([this] { return Says("path leads through what is known to be solid at ("); }))
      << Printed();
  EXPECT_EQ(motion_->state(), thalweg_msgs::msg::MOTION_STOPPED);
  // A path that is free is followed by the same controller.
  path = dds::StampedPath{.stamp = Time{} + 2s, .T_WBs = to(start.x() + 0.3)};
  ASSERT_TRUE(Until([this] { return motion_->state() == thalweg_msgs::msg::MOTION_DONE; })) << Printed();
  EXPECT_NEAR(Position().x(), start.x() + 0.3, 0.1);
  EXPECT_EQ(simulation_->true_collisions(), 0U);
  EXPECT_GT(simulation_->least_clearance_m(), 0.0);
}

TEST_F(FaultsSystemTest, AServiceThatWasSuspendedGoesOnAndIsNotTakenForOneThatHangs) {
  Start({"--set", "network.watchdog_s=2"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  const pid_t mapper = PidOf("mapper");
  kill(mapper, SIGSTOP);
  const auto stopped = std::chrono::steady_clock::now();
  ASSERT_TRUE(Until([&] { return std::chrono::steady_clock::now() - stopped > 5s; })) << Printed();
  kill(mapper, SIGCONT);
  ExpectComplete();
}

TEST_F(FaultsSystemTest, HealthyDistinguishesAServiceThatWorksFromOneThatIsStopped) {
  // At its usual speed the exploration may end before the check has heard two messages of the mapper.
  Start({"--set", "simulator.time_scale=1"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  const auto healthy = [&](const std::string& service) {
    RunningProgram check("thalweg-" + service, {"--healthy", "--scenario", "tiny"},
                         place_.folder() / (service + "-healthy.txt"));
    const auto status = check.WaitForEnd(30s);
    return status && WIFEXITED(*status) ? WEXITSTATUS(*status) : -1;
  };
  EXPECT_EQ(healthy("mapper"), 0);
  const pid_t mapper = PidOf("mapper");
  kill(mapper, SIGSTOP);
  EXPECT_EQ(healthy("mapper"), 1) << "it hangs";
  kill(mapper, SIGCONT);
  run_->Kill(SIGINT);
  ASSERT_TRUE(run_->WaitForEnd(60s));
  EXPECT_EQ(healthy("mapper"), 1) << "it does not run";
}

TEST_F(FaultsSystemTest, ALinkIsHealthyOnItsOwnSideOnly) {
  RunningProgram link("thalweg-link", {"--side", "onboard", "--scenario", "tiny"},
                      place_.folder() / "link.log");
  const auto healthy = [&](const std::string& side) {
    RunningProgram check("thalweg-link", {"--side", side, "--healthy", "--scenario", "tiny"},
                         place_.folder() / (side + "-healthy.txt"));
    const auto status = check.WaitForEnd(30s);
    return status && WIFEXITED(*status) ? WEXITSTATUS(*status) : -1;
  };
  EXPECT_EQ(healthy("onboard"), 0);
  EXPECT_EQ(healthy("offboard"), 1);
  link.Kill(SIGINT);
  EXPECT_TRUE(link.WaitForEnd(30s));
}

}  // namespace
}  // namespace thalweg::test
