#include "services/visual_odometry/adapter/visual_odometry_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/services/visual_odometry/support/textured_room.h"
#include "tests/support/test_bus.h"

namespace thalweg::visual_odometry {
namespace {

namespace topics = dds::topics;
using testing::HasSubstr;
using std::chrono_literals::operator""ms;

/// A topic outside the project.
struct Vehicle {
  using Message = nav_msgs::msg::Odometry;
  static constexpr auto kName = "vehicle/state";
  static constexpr auto kDelivery = dds::Delivery::kSamples;
};

/// A body whose camera is neither at its center nor level.
RigidTransform TiltedCamera() {
  return MakeTransform(RotationFromYawPitch(0.0, -0.2) * BodyFromOptical(),
                       Eigen::Vector3d(0.08, 0.02, 0.05));
}

/// The service on its own participant and thread, and a peer that publishes to it and listens.
class VisualOdometryServiceTest : public testing::Test {
 protected:
  VisualOdometryServiceTest() {
    bus_.Subscribe<topics::Odometry>([this](const auto& message) {
      const auto pose = dds::FromIdl(message);
      ASSERT_TRUE(pose) << pose.error();
      odometry_ = message;
      pose_ = *pose;
    });
    bus_.Subscribe<topics::Transforms>([this](const auto& message) { transforms_ = message; });
    bus_.Subscribe<topics::OdometryStatus>([this](const auto& message) { status_ = message; });
  }
  void TearDown() override { thread_ = {}; }

  void Start(const VisualOdometryOptions& options) {
    service_.emplace(options, own_bus_);
    thread_ = std::jthread([this](std::stop_token stop) { own_bus_.Spin(stop); });
  }
  bool Until(const std::function<bool()>& done) { return bus_.SpinUntil(done, thalweg::test::kPatience); }
  /// Starts the service with another publisher's PoseStamped as its source; returns once both are matched.
  void StartWithPosesFrom(const dds::Bus::Publisher<topics::OutsidePose>& out) {
    VisualOdometryOptions options;
    options.source = Source::kTopic;
    options.topic_type = TopicType::kPose;
    Start(options);
    ASSERT_TRUE(Until([&] { return out.readers() == 1 && bus_.Writers<topics::Odometry>() == 1; }));
  }
  /// Writes repeatedly, since samples may be lost, until odometry with that stamp has arrived.
  template <class Write>
  bool Says(Time stamp, Write&& write) {
    bus_.EveryWall(100ms, [&, write] { write(); });
    return Until([&] { return pose_ && pose_->stamp == stamp; });
  }
  bool IsState(thalweg_msgs::msg::OdometryState state) const { return status_ && status_->state() == state; }
  static Time At(double seconds) { return Time(FromSeconds(seconds)); }

  dds::Bus own_bus_{thalweg::test::BusOptionsForTest("visual-odometry")};
  std::optional<VisualOdometryService> service_;
  std::jthread thread_;
  dds::Bus bus_{thalweg::test::BusOptionsForTest("test")};
  std::optional<nav_msgs::msg::Odometry> odometry_;
  std::optional<dds::StampedPose> pose_;
  std::optional<tf2_msgs::msg::TFMessage> transforms_;
  std::optional<thalweg_msgs::msg::OdometryStatus> status_;
};

TEST_F(VisualOdometryServiceTest, FollowsTheImagesAndSaysWhenItCannot) {
  const StereoGeometry rig = test::SmallRig();
  const test::TexturedRoom room;
  VisualOdometryOptions options;
  options.T_BC = TiltedCamera();
  options.T_WB_start = test::RoomPose(0) * options.T_BC.inverse();
  Start(options);
  const auto left_out = bus_.Advertise<topics::LeftImage>();
  const auto right_out = bus_.Advertise<topics::RightImage>();
  const auto left_info_out = bus_.Advertise<topics::LeftCameraInfo>();
  const auto right_info_out = bus_.Advertise<topics::RightCameraInfo>();
  ASSERT_TRUE(Until([&] {
    return left_out.readers() == 1 && right_out.readers() == 1 && left_info_out.readers() == 1 &&
           right_info_out.readers() == 1 && bus_.Writers<topics::Odometry>() == 1 &&
           bus_.Writers<topics::OdometryStatus>() == 1 && bus_.Writers<topics::Transforms>() == 1;
  }));
  const auto write = [&](const StereoImages& images) {
    const auto to_message = [&](const cv::Mat& image) {
      return dds::ToIdl(images.stamp, dds::kCameraFrame, image.cols, image.rows, "mono8",
                        std::vector<std::uint8_t>(image.datastart, image.dataend));
    };
    left_info_out.Write(dds::ToIdl(images.stamp, rig.camera, 0.0));
    right_info_out.Write(dds::ToIdl(images.stamp, rig.camera, rig.baseline));
    left_out.Write(to_message(images.left));
    right_out.Write(to_message(images.right));
  };
  const auto has_seen = [&](Time stamp) { return status_ && status_->header().stamp() == dds::ToIdl(stamp); };
  for (int step = 0; step <= 12; ++step) {
    const StereoImages images = room.SeePair(rig, test::RoomPose(step), test::RoomStamp(step));
    // Images are sent best-effort, so they are repeated in case they were lost.
    for (int attempt = 0; attempt < 20 && !has_seen(images.stamp); ++attempt) {
      write(images);
      bus_.SpinUntil([&] { return has_seen(images.stamp); }, std::chrono::seconds(1));
    }
    ASSERT_TRUE(has_seen(images.stamp)) << step;
    // The service's writer may match later than our reader, so the first poses may be lost.
    const bool any = bus_.SpinUntil([&] { return pose_.has_value(); }, std::chrono::seconds(1));
    if (!any && step < 6) continue;
    ASSERT_TRUE(Until([&] { return pose_ && pose_->stamp == images.stamp; })) << step;
    const RigidTransform truth = test::RoomPose(step) * options.T_BC.inverse();
    EXPECT_LT((pose_->T.translation() - truth.translation()).norm(), 0.005) << step;
    EXPECT_TRUE(IsState(thalweg_msgs::msg::ODOMETRY_TRACKING)) << status_->reason();
  }
  EXPECT_EQ(status_->source(), thalweg_msgs::msg::ODOMETRY_FROM_STEREO);
  EXPECT_GT(status_->inliers(), 50U);
  EXPECT_GT(status_->position_sigma_m(), 0.0);
  EXPECT_GT(odometry_->pose().covariance()[0], 0.0);
  ASSERT_TRUE(transforms_);

  const Time last = pose_->stamp;
  StereoImages dark = room.SeePair(rig, test::RoomPose(13), test::RoomStamp(13));
  dark.left *= 0.02;
  for (int attempt = 0; attempt < 20 && !has_seen(dark.stamp); ++attempt) {
    write(dark);
    bus_.SpinUntil([&] { return has_seen(dark.stamp); }, std::chrono::seconds(1));
  }
  ASSERT_TRUE(IsState(thalweg_msgs::msg::ODOMETRY_LOST));
  EXPECT_THAT(status_->reason(), HasSubstr("dark"));
  EXPECT_EQ(status_->lost(), 1U);
  EXPECT_EQ(pose_->stamp, last) << "no pose is published while it is lost";
}

TEST_F(VisualOdometryServiceTest, TakesAnotherPublishersOdometryWithTheBodyInIt) {
  VisualOdometryOptions options;
  options.source = Source::kTopic;
  options.topic = Vehicle::kName;
  options.T_XB = MakeTransform(RotationFromYawPitch(0.5, 0.0), {0.1, 0.2, 0.3});
  Start(options);
  const auto out = bus_.Advertise<Vehicle>();
  ASSERT_TRUE(Until([&] { return out.readers() == 1 && bus_.Writers<topics::Odometry>() == 1; }));
  const RigidTransform T_WX = MakeTransform(RotationFromYawPitch(1.0, 0.1), {3, 2, 1});
  auto message = dds::OdometryToIdl(At(5.0), T_WX, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  message.header().frame_id("their_world");
  message.child_frame_id("their_body");
  ASSERT_TRUE(Says(At(5.0), [&] { out.Write(message); }));
  EXPECT_TRUE(pose_->T.isApprox(T_WX * options.T_XB, 1e-9));
}

TEST_F(VisualOdometryServiceTest, TakesAnotherPublishersPosesAndTheirSpeedFromThem) {
  const auto out = bus_.Advertise<topics::OutsidePose>();
  ASSERT_NO_FATAL_FAILURE(StartWithPosesFrom(out));
  const auto pose = [&](double x, double seconds) {
    return dds::PoseStampedToIdl(At(seconds),
                                 MakeTransform(RotationFromYawPitch(1.57079632679, 0.0), {x, 0, 0}));
  };
  ASSERT_TRUE(Says(At(5.0), [&, m = pose(1.0, 5.0)] {
    if (!pose_) out.Write(m);
  }));
  ASSERT_TRUE(Says(At(5.5), [&, m = pose(1.25, 5.5)] { out.Write(m); }));
  EXPECT_NEAR(odometry_->twist().twist().linear().y(), -0.5, 1e-6) << "along x of the world is to its right";
}

TEST_F(VisualOdometryServiceTest, RefusesOutsidePosesThatLie) {
  const auto out = bus_.Advertise<topics::OutsidePose>();
  ASSERT_NO_FATAL_FAILURE(StartWithPosesFrom(out));
  auto bad = dds::PoseStampedToIdl(At(1.0), RigidTransform::Identity());
  bad.pose().orientation().w(7.0);
  const auto good = dds::PoseStampedToIdl(At(2.0), RigidTransform::Identity());
  ASSERT_TRUE(Says(At(2.0), [&] {
    out.Write(bad);
    out.Write(good);
  }));
  own_bus_.Post([] {});
  thread_ = {};
  EXPECT_GE(own_bus_.health().rejected(), 1U);
}

TEST_F(VisualOdometryServiceTest, ReplaysAFileAndIsLostWhereItHasNoPose) {
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("replay-" + std::to_string(getpid()) + ".tum");
  const double begin = Seconds(bus_.Now().time_since_epoch());
  // Poses from now on, for a minute, at 0.5 m/s; the file's clock starts at 100.
  std::ofstream(file) << "100 0 0 1 0 0 0 1\n160 30 0 1 0 0 0 1\n";
  VisualOdometryOptions options;
  options.source = Source::kFile;
  options.file = file;
  options.longest_gap = std::chrono::seconds(100);
  options.file_offset = FromSeconds(begin - 100.0);
  Start(options);
  ASSERT_TRUE(Until([&] { return pose_.has_value() && status_ && odometry_; }));
  const double since = Seconds(pose_->stamp.time_since_epoch()) - begin;
  EXPECT_NEAR(pose_->T.translation().x(), 0.5 * since, 1e-3);
  ASSERT_TRUE(Until([&] { return odometry_->twist().twist().linear().x() > 0.4; }));
  EXPECT_NEAR(odometry_->twist().twist().linear().x(), 0.5, 0.01);
  thread_ = {};
  std::filesystem::remove(file);
}

TEST_F(VisualOdometryServiceTest, SaysThatTheFileHasNoPoseOfThisTime) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("old-" + std::to_string(getpid()) + ".tum");
  std::ofstream(file) << "100 0 0 1 0 0 0 1\n101 30 0 1 0 0 0 1\n";
  VisualOdometryOptions options;
  options.source = Source::kFile;
  options.file = file;
  Start(options);
  ASSERT_TRUE(Until([&] { return IsState(thalweg_msgs::msg::ODOMETRY_LOST); }));
  EXPECT_THAT(status_->reason(), HasSubstr("no pose of this time"));
  EXPECT_FALSE(pose_);
  std::filesystem::remove(file);
}

TEST_F(VisualOdometryServiceTest, HandsTheSimulatorsTruthOn) {
  VisualOdometryOptions options;
  options.source = Source::kTruth;
  Start(options);
  const auto out = bus_.Advertise<topics::TrueOdometry>();
  ASSERT_TRUE(Until([&] { return out.readers() == 1 && bus_.Writers<topics::Odometry>() == 1; }));
  const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(1.0, 0.1), {3, 2, 1});
  const auto message = dds::OdometryToIdl(At(7.0), T_WB, {0.5, 0, 0}, {0, 0, 0.1});
  ASSERT_TRUE(Says(At(7.0), [&] { out.Write(message); }));
  EXPECT_TRUE(pose_->T.isApprox(T_WB, 1e-9));
  EXPECT_DOUBLE_EQ(odometry_->twist().twist().linear().x(), 0.5);
}

/// The error that the service throws if it is to take poses from that topic.
std::string ErrorOfTopic(const std::string& topic, TopicType type) {
  dds::Bus bus(thalweg::test::BusOptionsForTest("visual-odometry"));
  VisualOdometryOptions options;
  options.source = Source::kTopic;
  options.topic = topic;
  options.topic_type = type;
  try {
    const VisualOdometryService service(options, bus);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(VisualOdometrySource, IsRefusedWhenItIsTheServicesOwnOutput) {
  EXPECT_THAT(ErrorOfTopic(topics::Odometry::kName, TopicType::kOdometry),
              AllOf(HasSubstr("\"odometry\""), HasSubstr("published by this process itself")));
}

TEST(VisualOdometrySource, IsRefusedWhenTheTopicCarriesAnotherType) {
  EXPECT_THAT(ErrorOfTopic(topics::Odometry::kName, TopicType::kPose),
              AllOf(HasSubstr("\"odometry\""), HasSubstr("nav_msgs::msg::dds_::Odometry_"),
                    HasSubstr("geometry_msgs::msg::dds_::PoseStamped_")));
}

TEST(VisualOdometrySource, TheScenarioRefusesEveryTopicThatTheServicePublishes) {
  for (const char* const topic :
       {topics::Odometry::kName, topics::OdometryStatus::kName, topics::Transforms::kName}) {
    Scenario scenario;
    scenario.mutable_visual_odometry()->set_topic(topic);
    EXPECT_THROW(CheckScenario(scenario), std::invalid_argument) << topic;
  }
}

TEST(OptionsFrom, ReadsTheScenario) {
  Scenario scenario;
  auto& given = *scenario.mutable_visual_odometry();
  EXPECT_EQ(OptionsFrom(scenario).source, Source::kStereo);
  EXPECT_FALSE(OptionsFrom(scenario).estimator.checks.detect_frozen) << "a simulated camera without noise";
  scenario.mutable_stereo_camera()->set_noise_sigma(1.0);
  EXPECT_TRUE(OptionsFrom(scenario).estimator.checks.detect_frozen);
  scenario.mutable_simulator()->mutable_start_position_m()->set_x(1.5);
  scenario.mutable_simulator()->set_start_yaw_deg(90);
  const RigidTransform start = OptionsFrom(scenario).T_WB_start;
  EXPECT_DOUBLE_EQ(start.translation().x(), 1.5);
  EXPECT_NEAR(start.linear()(1, 0), 1.0, 1e-12);
  scenario.mutable_simulator()->set_start_seed(3);
  EXPECT_THROW(OptionsFrom(scenario), std::invalid_argument) << "a random start is not known";
  EXPECT_EQ(OptionsFrom(Scenario()).topic_type, TopicType::kOdometry);
  given.set_topic_type(thalweg::VisualOdometry::POSE);
  given.mutable_start_position_m()->set_x(2.5);
  EXPECT_EQ(OptionsFrom(scenario).topic_type, TopicType::kPose);
  EXPECT_DOUBLE_EQ(OptionsFrom(scenario).T_WB_start.translation().x(), 2.5);
  given.set_source(thalweg::VisualOdometry::FILE);
  EXPECT_THROW(OptionsFrom(scenario), std::invalid_argument) << "no file";
}

TEST(BodyMotionFrom, ReportsOfTheBodyWhatTheCameraDoes) {
  // The body turns in place; the camera, in front of it, moves to the left.
  PoseEstimate estimate;
  const RigidTransform T_BC = MakeTransform(BodyFromOptical(), {0.2, 0, 0});
  estimate.w_OC_C = T_BC.linear().transpose() * Eigen::Vector3d(0, 0, 0.5);
  estimate.v_OC_C = T_BC.linear().transpose() * Eigen::Vector3d(0, 0.1, 0);
  estimate.covariance.diagonal() << 0, 0, 0, 0, 1e-4, 0;  // about the camera's y, which points down
  const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(1.0, 0.0), {1, 2, 3});
  const BodyMotion motion = BodyMotionFrom(estimate, T_WB * T_BC, T_BC);
  EXPECT_TRUE(motion.T_WB.isApprox(T_WB, 1e-12));
  EXPECT_LT(motion.v_WB_B.norm(), 1e-12);
  EXPECT_NEAR(motion.w_WB_B.z(), 0.5, 1e-12);
  // A body 0.2 m behind the camera swings with the camera's rotation: 0.01 rad are 2 mm sideways.
  EXPECT_NEAR(motion.covariance_W(5, 5), 1e-4, 1e-12);
  const Eigen::Vector3d sideways = T_WB.linear() * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(sideways.dot(motion.covariance_W.topLeftCorner<3, 3>() * sideways), 4e-6, 1e-12);
}

TEST(ToGray, TakesColorAndPadding) {
  std::vector<std::uint8_t> bytes(2 * 16, 0);
  for (int i = 0; i < 3; ++i) bytes[static_cast<std::size_t>(3 * i)] = 200;  // red, in row 0
  const dds::ImageView view{
      .stamp = {}, .width_px = 3, .height_px = 2, .step_bytes = 16, .encoding = "rgb8", .data = bytes.data()};
  const cv::Mat gray = ToGray(view);
  ASSERT_EQ(gray.size(), cv::Size(3, 2));
  EXPECT_NEAR(gray.at<std::uint8_t>(0, 2), 0.299 * 200, 1.0);
  EXPECT_EQ(gray.at<std::uint8_t>(1, 0), 0);
}

}  // namespace
}  // namespace thalweg::visual_odometry
