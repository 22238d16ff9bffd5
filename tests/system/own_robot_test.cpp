#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <thread>

#include "common/dds/convert.h"
#include "docs/examples/corridor.h"
#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

/// A robot in the corridor of docs/examples, in a thread of its own. Its depth camera publishes clouds or
/// images.
class CorridorRobot {
 public:
  enum class Depth { kClouds, kImages };

  /// What is wrong with its clouds.
  struct Faults {
    float scale = 1.0F;      ///< Factor on the coordinates, which else are meters.
    bool no_stamps = false;  ///< All stamps are 0.
  };

  /// @param camera_frame  What the clouds and images say that they are in.
  CorridorRobot(const dds::BusOptions& options, Depth depth, std::string camera_frame, const Faults& faults)
      : depth_(depth), camera_frame_(std::move(camera_frame)), faults_(faults), bus_(options) {
    bus_.Subscribe<topics::PoseCommand>([this](const auto& message) {
      const auto command = dds::FromIdl(message);
      ASSERT_TRUE(command) << command.error();
      T_WB_ = command->T;
    });
    bus_.EveryWall(20ms, [this] {
      odometry_out_.Write(dds::OdometryToIdl(Stamp(), T_WB_, {0, 0, 0}, {0, 0, 0}));
    });
    bus_.EveryWall(200ms, [this] { Look(); });
    thread_ = std::jthread([this](const std::stop_token& stop) {
      bus_.SpinUntil([&] { return stop.stop_requested(); }, std::chrono::hours(1));
    });
  }

 private:
  Time Stamp() const { return faults_.no_stamps ? Time{} : bus_.Now(); }
  void Look() {
    const Eigen::Quaterniond q_WB(T_WB_.linear());
    PointCloud cloud{
        .width_px = kCamera.width_px, .height_px = kCamera.height_px, .points_C = {}, .colors = {}};
    sensor_msgs::msg::Image image;
    for (int v = 0; v < kCamera.height_px; ++v) {
      for (int u = 0; u < kCamera.width_px; ++u) {
        const double right = (u - kCamera.cx) / kCamera.fx;
        const double down = (v - kCamera.cy) / kCamera.fy;
        const double depth = CorridorDepth(T_WB_.translation().data(), q_WB.coeffs().data(), right, down);
        cloud.points_C.push_back(faults_.scale * (depth * Eigen::Vector3d(right, down, 1.0)).cast<float>());
        const auto millimeters = static_cast<std::uint16_t>(std::lround(1000 * depth));
        image.data().push_back(static_cast<std::uint8_t>(millimeters & 0xff));
        image.data().push_back(static_cast<std::uint8_t>(millimeters >> 8));
      }
    }
    const Time now = Stamp();
    if (depth_ == Depth::kClouds) {
      auto message = dds::ToIdl(now, cloud);
      message.header().frame_id(camera_frame_);
      points_out_.Write(message);
      return;
    }
    image.header(dds::MakeHeader(now, camera_frame_));
    image.width(static_cast<std::uint32_t>(kCamera.width_px));
    image.height(static_cast<std::uint32_t>(kCamera.height_px));
    image.encoding("16UC1");
    image.step(2 * image.width());
    auto info = dds::ToIdl(now, kCamera, 0.0);
    info.header().frame_id(camera_frame_);
    images_out_.Write(image);
    infos_out_.Write(info);
  }

  static inline const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(120, 90, 1.396);  // 80 degrees
  Depth depth_;
  std::string camera_frame_;
  Faults faults_;
  RigidTransform T_WB_ = RigidTransform::Identity();
  dds::Bus bus_;
  dds::Bus::Publisher<topics::Odometry> odometry_out_ = bus_.Advertise<topics::Odometry>();
  dds::Bus::Publisher<topics::DepthPoints> points_out_ = bus_.Advertise<topics::DepthPoints>();
  dds::Bus::Publisher<topics::DepthImage> images_out_ = bus_.Advertise<topics::DepthImage>();
  dds::Bus::Publisher<topics::DepthCameraInfo> infos_out_ = bus_.Advertise<topics::DepthCameraInfo>();
  std::jthread thread_;
};

/// The scenario of docs/examples' robots with another text in place of one of its own, and more.
std::filesystem::path OwnRobotScenario(const std::filesystem::path& folder, const std::string& from,
                                       const std::string& to, const std::string& more) {
  std::ostringstream shipped;
  shipped << std::ifstream(SourceFolder() + "/deploy/scenarios/own_robot.txtpb").rdbuf();
  std::string text = shipped.str();
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the scenario has no " + from);
  text.replace(at, from.size(), to);
  std::ofstream(folder / "robot.txtpb") << text << more;
  return folder / "robot.txtpb";
}

class InItsCorridor : public RunSystemTest {
 protected:
  void ExpectCorridorCompleted() {
    const auto status = run_->WaitForEnd(200s);
    ASSERT_TRUE(status) << "it still runs; " << Printed();
    EXPECT_TRUE(WIFEXITED(*status) && WEXITSTATUS(*status) == 0) << cli::DescribeEnd(*status) << "\n"
                                                                 << Printed();
    const auto report = Report();
    EXPECT_EQ(report["outcome"], "complete");
    EXPECT_EQ(report["stop_reason"], "complete");
    EXPECT_EQ(report["messages_rejected"]["total"], 0) << report["messages_rejected"];
    // The corridor has 5 x 1.6 x 1.8 m, of which the crate takes 0.5 x 0.7 x 1.1 m. Their surfaces lie
    // between voxels of 0.1 m, of which either may be the occupied one.
    EXPECT_LE(report["free_m3"], 5.0 * 1.6 * 1.8 - 0.5 * 0.7 * 1.1);
    EXPECT_GE(report["free_m3"], 4.8 * 1.4 * 1.6 - 0.7 * 0.9 * 1.3);
  }
  dds::BusOptions RobotOptions() const {
    dds::BusOptions options = place_.BusOptions();
    options.name = "robot";
    return options;
  }
};

/// The robots of docs/examples, which know no partition, as docs/guide/own-robot.md builds and runs them.
class OwnRobotSystemTest : public InItsCorridor {
 protected:
  OwnRobotSystemTest() { unsetenv("THALWEG_PARTITION"); }

  void RunWith(const std::filesystem::path& robot) {
    const RunningProgram running(robot.string(), {std::to_string(place_.domain())},
                                 place_.folder() / "robot.log");
    StartScenario("own_robot", {"--without", "simulator"});
    ExpectCorridorCompleted();
  }

  /// The lines of the guide that build the robot in C, for another folder.
  static std::string BuildCommands(const std::filesystem::path& folder) {
    std::ostringstream guide;
    guide << std::ifstream(SourceFolder() + "/docs/guide/own-robot.md").rdbuf();
    const std::string text = guide.str();
    const std::size_t begin = text.find("mkdir -p /tmp/my_robot");
    const std::size_t end = text.find("```", begin);
    if (begin == std::string::npos) throw std::runtime_error("the guide builds no robot");
    return std::regex_replace(text.substr(begin, end - begin), std::regex("/tmp/my_robot"), folder.string());
  }
};

TEST_F(OwnRobotSystemTest, TheRobotInCIsBuiltByTheGuidesCommandsAndCompletesItsCorridor) {
  const std::filesystem::path folder = place_.folder() / "robot";
  const std::string build = "cd '" + SourceFolder() + "' && set -e\n" + BuildCommands(folder);
  ASSERT_EQ(std::system(build.c_str()), 0) << build;
  RunWith(folder / "my_robot");
}

TEST_F(OwnRobotSystemTest, TheRobotInCppCompletesItsCorridor) {
  RunWith(std::filesystem::path(BinFolder()) / "my_robot");
}

TEST_F(InItsCorridor, ARobotWithADepthImageAndNamesOfItsOwnIsLedByItsScenario) {
  dds::BusOptions options = RobotOptions();
  options.names.robot = "scout";
  options.names.topics = {{topics::Odometry::kName, "/wheel_odometry"},
                          {topics::DepthImage::kName, "camera/depth/image_rect"},
                          {topics::DepthCameraInfo::kName, "camera/depth/camera_info"},
                          {topics::PoseCommand::kName, "goal_pose"}};
  options.names.frames = {
      .map = "world", .odometry = "odom", .body = "base_footprint", .camera = "camera_depth_optical_frame"};
  const CorridorRobot robot(options, CorridorRobot::Depth::kImages, dds::kCameraFrame, {});
  StartScenario(OwnRobotScenario(place_.folder(), "depth_source: EXTERNAL", "depth_source: DEPTH_IMAGE", R"(
topics {
  odometry: "/wheel_odometry"
  depth_image: "camera/depth/image_rect"
  depth_camera_info: "camera/depth/camera_info"
  command_pose: "goal_pose"
}
frames { map: "world"  base_link: "base_footprint"  camera: "camera_depth_optical_frame" }
)"),
                {"--without", "simulator", "--set", "robot.name=scout"});
  ExpectCorridorCompleted();
}

/// What a robot does wrong, and what then stands on the screen, in the summary and in the report.
struct Wrong {
  const char* name;
  std::string camera_frame;
  CorridorRobot::Faults faults;
  std::string warning;
};
void PrintTo(const Wrong& wrong, std::ostream* out) {
  *out << wrong.name;
}

std::string NameOfWrong(const testing::TestParamInfo<Wrong>& wrong) {
  return wrong.param.name;
}

class AWrongRobot : public InItsCorridor, public testing::WithParamInterface<Wrong> {};

TEST_P(AWrongRobot, IsExplainedOnTheScreenAndInTheReport) {
  const CorridorRobot robot(RobotOptions(), CorridorRobot::Depth::kClouds, GetParam().camera_frame,
                            GetParam().faults);
  StartScenario("own_robot", {"--without", "simulator"});
  const std::string& expected = GetParam().warning;
  ASSERT_TRUE(Until([&] { return Printed().find(expected) != std::string::npos; })) << Printed();
  const std::size_t live = Printed().size();
  run_->Kill(SIGINT);
  ASSERT_TRUE(run_->WaitForEnd(60s)) << Printed();
  EXPECT_NE(Printed().find(expected, live), std::string::npos) << Printed();
  const auto warnings = Report()["warnings"].get<std::vector<std::string>>();
  EXPECT_THAT(warnings, testing::Contains(expected));
}

INSTANTIATE_TEST_SUITE_P(
    Faults, AWrongRobot,
    testing::Values(
        Wrong{"Frame",
              "lidar",
              {},
              "mapper rejects depth/points: frame_id is \"lidar\", must be \"camera_optical_frame\" or what "
              "frames.camera says"},
        Wrong{
            "Millimeters",
            dds::kCameraFrame,
            {.scale = 1000.0F},
            "mapper rejects depth/points: nearly all of its points are more than 100 m away: they must be in "
            "meters, are they in millimeters?"},
        Wrong{"NoStamps",
              dds::kCameraFrame,
              {.no_stamps = true},
              "mapper rejects depth/points: its stamp is 0: set header.stamp by the clock of all services"}),
    NameOfWrong);

}  // namespace
}  // namespace thalweg::test
