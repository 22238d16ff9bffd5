#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "tests/system/processes.h"

namespace thalweg::test {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using testing::HasSubstr;

constexpr double kVoxel = 0.1;

/// `thalweg watch` as typed by a user; the test takes the roles of the robot, mapper and explorer that it
/// watches.
class WatchSystemTest : public testing::Test {
 protected:
  WatchSystemTest() {
    std::ofstream(ScenarioFile()) << "title: 'A robot of flesh'\nnetwork { wall_clock: true }\n";
    for (int x = 0; x < 20; ++x) See({x, 0, 0}, x < 15 ? -1.0F : 1.0F);
    bus_.EveryWall(20ms, [] {});  // conditions are checked again after each event
    bus_.Subscribe<topics::MapRequests>([this](const auto& request) {
      map_reader_ = request.reader();
      map_out_.Write(log_.FullCopy(grid_));
    });
  }

  std::string ScenarioFile() const { return place_.folder() / "robot.txtpb"; }
  std::filesystem::path Out() const { return place_.folder() / "out"; }
  std::filesystem::path Screen() const { return place_.folder() / "screen.txt"; }

  /// Starts the program and waits until it receives everything that the test publishes.
  void Start() {
    watch_.emplace("thalweg", std::vector<std::string>{"watch", ScenarioFile(), "--out", Out()}, Screen());
    ASSERT_TRUE(Until([this] {
      return map_out_.readers() > 0 && odometry_out_.readers() > 0 && status_out_.readers() > 0;
    })) << Printed();
  }
  bool Until(const std::function<bool()>& done) {
    return bus_.SpinUntil([&] { return done() || watch_->ended(); }, 30s) && done();
  }
  int ExitCode() {
    std::optional<int> status;
    bus_.SpinUntil([&] { return (status = watch_->WaitForEnd(Duration(0))).has_value(); }, 30s);
    return status && WIFEXITED(*status) ? WEXITSTATUS(*status) : -1;
  }
  std::string Printed() const {
    std::ostringstream text;
    text << std::ifstream(Screen()).rdbuf();
    return text.str();
  }
  nlohmann::json Report() const { return nlohmann::json::parse(std::ifstream(Out() / "report.json")); }

  void See(const VoxelIndex& voxel, float log_odds) {
    grid_.Set(voxel, log_odds);
    const VoxelChange change{voxel, log_odds};
    log_.Add(bus_.Now(), {.T_WC = RigidTransform::Identity()}, {&change, 1});
  }
  /// Rests for one second, so that readers can match, moves by one meter in the next, and rests again.
  void Move() {
    const double x = std::clamp(0.01 * (++ticks_ - 100), 0.0, 1.0);
    const RigidTransform T_WB = MakeTransform(Eigen::Matrix3d::Identity(), {x, 0.0, 1.0});
    odometry_out_.Write(dds::OdometryToIdl(bus_.Now(), T_WB, {0.5, 0.0, 0.0}, Eigen::Vector3d::Zero()));
  }
  void SayDone(thalweg_msgs::msg::ExplorationOutcome outcome, const std::string& reason) {
    thalweg_msgs::msg::ExplorationStatus status;
    status.header(dds::MakeHeader(bus_.Now(), dds::kMapFrame));
    status.strategy("closest");
    status.state(thalweg_msgs::msg::EXPLORATION_DONE);
    status.outcome(outcome);
    status.stop_reason(reason);
    status.plans(12);
    status_out_.Write(status);
    See({0, 1, 0}, -1.0F);  // first seen at the end, so that the map must be in step
    map_out_.Write(log_.TakeUpdate());
  }
  /// A whole run that ends for the given reason.
  void Explore(thalweg_msgs::msg::ExplorationOutcome outcome, const std::string& reason) {
    Start();
    bus_.EveryWall(10ms, [this] { Move(); });
    ASSERT_TRUE(Until([this] { return ticks_ > 300 && !map_reader_.empty(); })) << Printed();
    SayDone(outcome, reason);
  }

  OwnPlace place_;
  dds::Bus bus_{place_.BusOptions()};
  dds::Bus::Publisher<topics::MapUpdates> map_out_ = bus_.Advertise<topics::MapUpdates>();
  dds::Bus::Publisher<topics::Odometry> odometry_out_ = bus_.Advertise<topics::Odometry>();
  dds::Bus::Publisher<topics::ExplorationStatus> status_out_ = bus_.Advertise<topics::ExplorationStatus>();
  OccupancyGrid grid_{kVoxel};
  dds::MapLog log_{dds::MapLog::MakeSession(), kVoxel};
  int ticks_ = 0;
  std::string map_reader_;
  std::optional<RunningProgram> watch_;
};

TEST_F(WatchSystemTest, ReportsARunOfProcessesThatItDidNotStart) {
  Explore(thalweg_msgs::msg::OUTCOME_COMPLETE, "complete");
  EXPECT_EQ(ExitCode(), 0) << Printed();
  EXPECT_EQ(map_reader_, "thalweg");
  const auto report = Report();
  EXPECT_EQ(report["scenario"], "robot");
  EXPECT_EQ(report["strategy"], "closest");
  EXPECT_EQ(report["stop_reason"], "complete");
  EXPECT_EQ(report["plans"], 12);
  EXPECT_NEAR(report["distance_m"], 1.0, 1e-6);
  EXPECT_GT(report["duration_s"], 1.5);
  EXPECT_NEAR(report["free_m3"], 0.016, 1e-9);
  EXPECT_NEAR(report["occupied_m3"], 0.005, 1e-9);
  for (const char* unknown : {"agreement", "coverage", "true_collisions", "least_clearance_m"}) {
    EXPECT_TRUE(report[unknown].is_null()) << unknown << " of a real robot";
  }
  for (const char* file : {"report.png", "trajectory.tum"}) {
    EXPECT_GT(std::filesystem::file_size(Out() / file), 0U) << file;
  }
  EXPECT_THAT(Printed(), HasSubstr("scenario robot, DDS domain " + std::to_string(place_.domain()) +
                                   ", files in " + Out().string()));
  EXPECT_THAT(Printed(), HasSubstr("complete: 1.0 m in "));
}

TEST_F(WatchSystemTest, ExplorationThatEndsOtherwiseIsNoSuccess) {
  Explore(thalweg_msgs::msg::OUTCOME_TIME_BUDGET, "time budget");
  EXPECT_EQ(ExitCode(), 1) << Printed();
  EXPECT_EQ(Report()["stop_reason"], "time budget");
}

TEST_F(WatchSystemTest, CtrlCEndsItAndLeavesAReportOfWhatWasHeard) {
  Start();
  ASSERT_TRUE(Until([this] {
    return Printed().find("no pose, map, explorer, controller yet") != std::string::npos;
  })) << Printed();
  watch_->Kill(SIGINT);
  EXPECT_EQ(ExitCode(), 1) << Printed();
  EXPECT_EQ(Report()["stop_reason"], "interrupted");
  EXPECT_EQ(Report()["distance_m"], 0.0);
}

TEST_F(WatchSystemTest, TheFolderOfAnotherRunIsLeftAlone) {
  std::filesystem::create_directories(Out());
  std::ofstream(Out() / "report.json") << "another";
  watch_.emplace("thalweg", std::vector<std::string>{"watch", ScenarioFile(), "--out", Out()}, Screen());
  EXPECT_EQ(ExitCode(), 1);
  EXPECT_THAT(Printed(), testing::StartsWith("thalweg: " + Out().string() + " already holds a run"));
  std::ifstream report(Out() / "report.json");
  std::string text;
  report >> text;
  EXPECT_EQ(text, "another");
}

}  // namespace
}  // namespace thalweg::test
