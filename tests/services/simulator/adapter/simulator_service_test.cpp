#include "services/simulator/adapter/simulator_service.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <limits>
#include <thread>

#include "common/dds/convert.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;

dds::BusOptions BusOptionsFor(const char* name) {
  dds::BusOptions options;
  options.name = name;
  options.domain = 62;
  options.partition = "simulator-test-" + std::to_string(getpid());
  return options;
}

SimulatorOptions FastOptions() {
  SimulatorOptions options;
  options.T_WB_start = MakeTransform(Eigen::Matrix3d::Identity(), {0.5, 0, 0});
  options.time_scale = 4.0;
  return options;
}

/// A room of 4 x 4 x 2 m about the origin.
World Room() {
  return {test::BoxMesh({-2.03, -2.03, -1.03}, {1.97, 1.97, 0.97}),
          Eigen::AlignedBox3d(Eigen::Vector3d(-2.1, -2.1, -1.1), Eigen::Vector3d(2, 2, 1))};
}

/// The simulator on its own participant and thread.
class RunningSimulator {
 public:
  explicit RunningSimulator(const SimulatorOptions& options, World world = Room())
      : bus_(WithClockOfItsOwn(BusOptionsFor("simulator"))), service_(options, std::move(world), bus_) {}

  /// Evaluates a question on the simulator's own thread.
  template <class T>
  T Ask(const std::function<T(dds::Bus&)>& question) {
    std::promise<T> answer;
    bus_.Post([&] { answer.set_value(question(bus_)); });
    return answer.get_future().get();
  }
  unsigned long long Rejected() {
    return Ask<unsigned long long>([](dds::Bus& bus) { return bus.health().rejected(); });
  }
  unsigned long long Dropped() {
    return Ask<unsigned long long>([](dds::Bus& bus) { return bus.health().dropped(); });
  }

 private:
  static dds::BusOptions WithClockOfItsOwn(dds::BusOptions options) {
    options.clock = dds::ClockSource::kOwn;
    return options;
  }

  dds::Bus bus_;
  SimulatorService service_;
  std::jthread thread_{[this](std::stop_token stop) { bus_.Spin(stop); }};
};

/// A subscriber that stores what it receives.
class SimulatorServiceTest : public testing::Test {
 protected:
  SimulatorServiceTest() {
    bus_.Subscribe<topics::Clock>([this](const auto& message) { now_ = *dds::FromIdl(message.clock()); });
    bus_.Subscribe<topics::Odometry>([this](const auto& message) {
      const auto odometry = dds::FromIdl(message);
      ASSERT_TRUE(odometry) << odometry.error();
      odometry_ = *odometry;
      odometry_stamps_.push_back(odometry->stamp);
    });
    bus_.Subscribe<topics::SimulationStatus>([this](const auto& message) { status_ = message; });
    bus_.Subscribe<topics::DepthPoints>([this](const auto& message) {
      const auto cloud = dds::FromIdl(message);
      ASSERT_TRUE(cloud) << cloud.error();
      clouds_.push_back(*cloud);
    });
  }

  bool Until(const std::function<bool()>& done) { return bus_.SpinUntil(done, 20s); }
  /// Repeats a command at each tick of the simulator's clock until `done` returns true.
  bool CommandUntil(const RigidTransform& target, const std::function<bool()>& done) {
    Time sent{};
    return Until([&] {
      if (now_ != sent) command_out_.Write(dds::PoseStampedToIdl(now_, target));
      sent = now_;
      return done();
    });
  }
  bool Ready() const { return odometry_ && command_out_.readers() == 1; }

  dds::Bus bus_{BusOptionsFor("test")};
  dds::Bus::Publisher<topics::PoseCommand> command_out_ = bus_.Advertise<topics::PoseCommand>();
  Time now_{};
  std::optional<dds::StampedPose> odometry_;
  std::vector<Time> odometry_stamps_;
  std::vector<dds::StampedCloud> clouds_;
  std::optional<thalweg_msgs::msg::SimulationStatus> status_;
};

TEST_F(SimulatorServiceTest, ReportsTimeAndPoseFromTheStart) {
  RunningSimulator simulator(FastOptions());
  ASSERT_TRUE(Until([this] { return now_ > Time{1s} && odometry_ && status_; }));
  EXPECT_LT((odometry_->T.translation() - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-9);
  EXPECT_EQ(status_->true_collisions(), 0U);
  EXPECT_NEAR(status_->clearance_m(), 0.97 - RobotModel().radius, 1e-5) << "to the ceiling";
  EXPECT_EQ(odometry_->stamp.time_since_epoch() % std::chrono::milliseconds(20), Duration::zero());
}

TEST_F(SimulatorServiceTest, ItsHealthIsStampedByItsOwnClock) {
  std::optional<Time> stamp;
  bus_.Subscribe<topics::Health>([&](const auto& message) {
    if (message.service() == "simulator") stamp = *dds::FromIdl(message.header().stamp());
  });
  RunningSimulator simulator(FastOptions());
  ASSERT_TRUE(Until([&] { return stamp && now_ > *stamp; }));
  EXPECT_GT(*stamp, Time{});
}

TEST_F(SimulatorServiceTest, FliesToTheCommandedPoseAndStandsWhenCommandsEnd) {
  RunningSimulator simulator(FastOptions());
  ASSERT_TRUE(Until([this] { return Ready(); }));
  const RigidTransform target = MakeTransform(RotationFromYawPitch(0.5, 0.0), {-1.0, 0.4, 0.1});
  const auto moved = [this] { return odometry_->T.translation().x() < 0.2; };
  ASSERT_TRUE(CommandUntil(target, moved));
  const Time silent_since = now_;
  const Eigen::Vector3d place = odometry_->T.translation();
  ASSERT_TRUE(Until([&] { return odometry_->stamp > silent_since + 2s; }));
  EXPECT_LT((odometry_->T.translation() - place).norm(), 0.5 * 0.8) << "stood within half a second or so";
  ASSERT_TRUE(CommandUntil(
      target, [&] { return (odometry_->T.translation() - target.translation()).norm() < 1e-6; }));
  EXPECT_LT(AngleBetween(odometry_->T, target), 1e-3);
}

TEST_F(SimulatorServiceTest, ReportsATrueCollisionAndStaysInTheRoom) {
  RunningSimulator simulator(FastOptions());
  ASSERT_TRUE(Until([this] { return Ready(); }));
  const RigidTransform beyond = MakeTransform(Eigen::Matrix3d::Identity(), {3.0, 0, 0});
  ASSERT_TRUE(CommandUntil(beyond, [this] { return status_ && status_->true_collisions() == 1; }));
  EXPECT_LT(status_->map_from_body_true().position().x(), 1.97 - RobotModel().radius + 1e-6);
  EXPECT_NEAR(status_->least_clearance_m(), 0.0, 2e-3);
}

TEST_F(SimulatorServiceTest, RefusesCommandsThatLieAndDropsOldOnes) {
  RunningSimulator simulator(FastOptions());
  ASSERT_TRUE(Until([this] { return Ready() && now_ > Time{2s}; }));
  auto no_number = dds::PoseStampedToIdl(now_, RigidTransform::Identity());
  no_number.pose().position().x(std::numeric_limits<double>::quiet_NaN());
  auto no_rotation = dds::PoseStampedToIdl(now_, RigidTransform::Identity());
  no_rotation.pose().orientation().w(3.0);
  auto elsewhere = dds::PoseStampedToIdl(now_, RigidTransform::Identity());
  elsewhere.header().frame_id("moon");
  unsigned long long refused = 0;
  for (const auto& lie : {no_number, no_rotation, elsewhere}) {
    command_out_.Write(lie);
    ++refused;
    ASSERT_TRUE(Until([&] { return simulator.Rejected() == refused; }));
  }
  command_out_.Write(dds::PoseStampedToIdl(now_ - 1s, RigidTransform::Identity()));
  ASSERT_TRUE(Until([&] { return simulator.Dropped() == 1; }));
  EXPECT_LT((odometry_->T.translation() - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-9);
}

TEST_F(SimulatorServiceTest, CloudsComeAtTheSensorsRateAndShowTheWall) {
  SimulatorOptions options = FastOptions();
  options.depth_sensor.rate = 10.0;
  RunningSimulator simulator(options);
  ASSERT_TRUE(Until([this] { return clouds_.size() >= 8; }));
  for (std::size_t i = 1; i < clouds_.size(); ++i) {
    const Duration gap = clouds_[i].stamp - clouds_[i - 1].stamp;
    EXPECT_EQ(gap % std::chrono::milliseconds(100), Duration::zero());
  }
  const auto middle = clouds_.back().cloud.points_C[50 * 100 + 50];
  EXPECT_NEAR(middle.z(), 1.47F, 1e-4F);
  // Each cloud has a pose of exactly the same time, but a best-effort reader may miss some on a loaded
  // machine.
  const auto with_pose = std::count_if(clouds_.begin(), clouds_.end(), [this](const auto& cloud) {
    return std::find(odometry_stamps_.begin(), odometry_stamps_.end(), cloud.stamp) != odometry_stamps_.end();
  });
  EXPECT_GE(with_pose, 4);
}

TEST_F(SimulatorServiceTest, SlowCamerasSlowTimeDownInsteadOfLosingPictures) {
  SimulatorOptions options = FastOptions();
  options.time_scale = 0.0;
  options.depth_sensor.camera = PinholeCamera::FromFieldOfView(300, 300, 1.3);
  options.depth_sensor.rate = 50.0;
  RunningSimulator simulator(options);
  ASSERT_TRUE(Until([this] { return clouds_.size() >= 20; }));
  const auto first = clouds_.end() - 10;
  EXPECT_LE(clouds_.back().stamp - first->stamp, std::chrono::milliseconds(3 * 9 * 20))
      << "the stamps would be far apart if time had run on";
}

TEST_F(SimulatorServiceTest, StereoPairsComeWithTheirCalibration) {
  SimulatorOptions options = FastOptions();
  options.stereo_camera.emplace();
  options.stereo_camera->camera = PinholeCamera::FromFieldOfView(160, 120, 1.15);
  std::optional<sensor_msgs::msg::Image> left;
  std::optional<sensor_msgs::msg::Image> right;
  std::optional<dds::StampedCamera> info;
  bus_.Subscribe<topics::LeftImage>([&](const auto& message) { left = message; });
  bus_.Subscribe<topics::RightImage>([&](const auto& message) { right = message; });
  bus_.Subscribe<topics::RightCameraInfo>([&](const auto& message) { info = *dds::FromIdl(message); });
  RunningSimulator simulator(options);
  ASSERT_TRUE(Until([&] {
    return left && right && info && left->header().stamp() == right->header().stamp() &&
           dds::FromIdl(left->header().stamp()) && *dds::FromIdl(left->header().stamp()) == info->stamp;
  }));
  const auto image = dds::FromIdl(*left);
  ASSERT_TRUE(image) << image.error();
  EXPECT_EQ(image->encoding, "mono8");
  EXPECT_EQ(image->width_px, 160);
  EXPECT_EQ(image->height_px, 120);
  EXPECT_NEAR(info->baseline, 0.12, 1e-9);
  EXPECT_NEAR(info->camera.fx, options.stereo_camera->camera.fx, 1e-9);
}

TEST_F(SimulatorServiceTest, EachCloudShowsADoorWhereItIsAtItsStamp) {
  // A slab across the view that comes nearer and goes back, at 0.4 m/s, for ever.
  const MovingPart slab{.at_rest_W = {Eigen::Vector3d(1.7, -1, -1), Eigen::Vector3d(1.8, 1, 0.9)},
                        .places = {{.time = 0}, {.time = 1, .offset_W = Eigen::Vector3d(-0.4, 0, 0)}},
                        .period = 2.0};
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(-2.1, -2.1, -1.1), Eigen::Vector3d(2, 2, 1));
  SimulatorOptions options = FastOptions();
  options.time_scale = 0.0;
  options.depth_sensor.rate = 25.0;
  options.depth_sensor.disparity_noise_px = 0.0;
  options.depth_sensor.camera = PinholeCamera::FromFieldOfView(200, 200, 1.3);
  RunningSimulator simulator(
      options, World(test::BoxMesh({-2.03, -2.03, -1.03}, {1.97, 1.97, 0.97}), bounds, {}, {slab}));
  ASSERT_TRUE(Until([this] { return clouds_.size() >= 30; }));
  float nearest = 9.0F;
  float farthest = 0.0F;
  for (const dds::StampedCloud& cloud : clouds_) {
    const double at = PoseAt(slab, Seconds(cloud.stamp.time_since_epoch())).translation().x();
    const auto depth = static_cast<float>(1.7 + at - 0.5);  // the camera is at x = 0.5
    for (const std::size_t pixel : {100U * 200U + 100U, 80U * 200U + 60U, 130U * 200U + 150U}) {
      ASSERT_NEAR(cloud.cloud.points_C[pixel].z(), depth, 1e-4F) << Seconds(cloud.stamp.time_since_epoch());
    }
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  EXPECT_GT(farthest - nearest, 0.2F) << "it moved meanwhile";
}

TEST_F(SimulatorServiceTest, ADoorWaitsForTheRobotAndItsApproachIsNoted) {
  const MovingPart slab{.at_rest_W = {Eigen::Vector3d(1.7, -1, -1), Eigen::Vector3d(1.8, 1, 0.9)},
                        .places = {{.time = 0}, {.time = 2, .offset_W = Eigen::Vector3d(-3.0, 0, 0)}}};
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(-2.1, -2.1, -1.1), Eigen::Vector3d(2, 2, 1));
  RunningSimulator simulator(
      FastOptions(), World(test::BoxMesh({-2.03, -2.03, -1.03}, {1.97, 1.97, 0.97}), bounds, {}, {slab}));
  ASSERT_TRUE(Until([this] { return status_ && now_ > Time{4s}; }));
  EXPECT_EQ(status_->true_collisions(), 0U);
  EXPECT_GE(status_->clearance_m(), PartInMotion::kKeepOff - 1e-6);
  EXPECT_LT(status_->clearance_m(), PartInMotion::kKeepOff + 0.04);
  EXPECT_NEAR(status_->least_clearance_m(), status_->clearance_m(), 1e-9);
}

}  // namespace
}  // namespace thalweg::simulator
