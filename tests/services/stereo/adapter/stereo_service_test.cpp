#include "services/stereo/adapter/stereo_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/stereo/adapter/convert.h"
#include "tests/support/log_text.h"
#include "tests/support/random_images.h"
#include "tests/support/test_bus.h"

namespace thalweg::stereo {
namespace {

namespace topics = dds::topics;
using thalweg::test::BusOptionsForTest;
using thalweg::test::kPatience;
using thalweg::test::LogText;

const PinholeCamera kCamera{160, 120, 120.0, 120.0, 79.5, 59.5};
constexpr double kBaseline = 0.1;
constexpr double kDisparity = 8.0;
constexpr double kDepth = 120.0 * kBaseline / kDisparity;

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

/// The service on one bus, a camera and a listener on another; the two spin in turn.
class StereoServiceTest : public testing::Test {
 protected:
  StereoServiceTest() {
    camera_bus_.Subscribe<topics::DepthPoints>([this](const auto& message) {
      const auto cloud = dds::FromIdl(message);
      ASSERT_TRUE(cloud) << cloud.error();
      clouds_.push_back(*cloud);
    });
    camera_bus_.Subscribe<topics::Disparity>(
        [this](const auto& message) { disparities_.push_back(message); });
  }

  void Start() {
    service_.emplace(options_, service_bus_);
    const bool infos = !options_.calibration;
    ASSERT_TRUE(Until([&] {
      return left_.readers() > 0 && right_.readers() > 0 && camera_bus_.Writers<topics::DepthPoints>() > 0 &&
             camera_bus_.Writers<topics::Disparity>() > 0 && service_bus_.Writers<topics::LeftImage>() > 0 &&
             service_bus_.Writers<topics::RightImage>() > 0 &&
             (!infos || (left_info_.readers() > 0 && right_info_.readers() > 0 &&
                         service_bus_.Writers<topics::LeftCameraInfo>() > 0 &&
                         service_bus_.Writers<topics::RightCameraInfo>() > 0));
    }));
  }
  bool Until(const std::function<bool()>& done) {
    constexpr auto kTurn = std::chrono::milliseconds(5);
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!camera_bus_.SpinUntil(done, kTurn)) {
      if (std::chrono::steady_clock::now() > end) return false;
      service_bus_.SpinUntil([] { return false; }, kTurn);
    }
    return true;
  }
  static sensor_msgs::msg::Image Message(Time stamp, const ByteImage& image) {
    return dds::ToIdl(stamp, dds::kCameraFrame, image.width(), image.height(), "mono8", image.data());
  }
  /// Sends pairs until the service publishes a cloud with that stamp, since streams may lose a message.
  bool SendUntilMatched(Time stamp) {
    for (int attempt = 0; attempt < 40; ++attempt) {
      SendInfos(stamp);
      SendPair(stamp);
      const std::size_t before = clouds_.size();
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
      if (Until([&] { return clouds_.size() > before || std::chrono::steady_clock::now() > end; }) &&
          clouds_.size() > before) {
        return true;
      }
      stamp += std::chrono::milliseconds(10);
    }
    return false;
  }
  void SendInfos(Time stamp) {
    left_info_.Write(dds::ToIdl(stamp, camera_, 0.0));
    sensor_msgs::msg::CameraInfo right = dds::ToIdl(stamp, camera_, kBaseline);
    if (right_k_) right.k(*right_k_);
    right_info_.Write(right);
  }
  void SendPair(Time stamp) {
    left_.Write(Message(stamp, pair_.left));
    right_.Write(Message(stamp, pair_.right));
  }
  unsigned long long rejected() { return service_bus_.health().rejected(); }
  unsigned long long dropped() { return service_bus_.health().dropped(); }

  StereoOptions options_;  ///< May be changed before Start().
  PinholeCamera camera_ = kCamera;
  std::optional<std::array<double, 9>> right_k_;  ///< K of a raw image.
  test::Pair pair_ = test::PlanePair(kCamera.width_px, kCamera.height_px, 0.0, 0.0, kDisparity, 21);
  dds::Bus service_bus_{BusOptionsForTest("stereo")};
  dds::Bus camera_bus_{BusOptionsForTest("camera")};
  dds::Bus::Publisher<topics::LeftImage> left_ = camera_bus_.Advertise<topics::LeftImage>();
  dds::Bus::Publisher<topics::RightImage> right_ = camera_bus_.Advertise<topics::RightImage>();
  dds::Bus::Publisher<topics::LeftCameraInfo> left_info_ = camera_bus_.Advertise<topics::LeftCameraInfo>();
  dds::Bus::Publisher<topics::RightCameraInfo> right_info_ = camera_bus_.Advertise<topics::RightCameraInfo>();
  std::vector<dds::StampedCloud> clouds_;
  std::vector<stereo_msgs::msg::DisparityImage> disparities_;
  std::optional<StereoService> service_;
};

TEST_F(StereoServiceTest, PublishesTheCloudAndTheDisparityOfAPair) {
  Start();
  ASSERT_TRUE(SendUntilMatched(At(1)));
  const PointCloud& cloud = clouds_.back().cloud;
  EXPECT_EQ(cloud.width_px, 160);
  EXPECT_EQ(cloud.height_px, 120);
  EXPECT_GE(clouds_.back().stamp, At(1));
  const Eigen::Vector3f& p = cloud.points_C[60 * 160 + 100];
  EXPECT_NEAR(p.z(), kDepth, 0.05);
  EXPECT_NEAR(p.x(), (100 - 79.5) / 120.0 * kDepth, 0.02);
  EXPECT_EQ(cloud.colors[60 * 160 + 100].r, pair_.left(100, 60));
  ASSERT_TRUE(Until([&] { return !disparities_.empty(); }));
  EXPECT_EQ(disparities_.back().image().encoding(), "32FC1");
}

TEST_F(StereoServiceTest, WarnsOnceOfRowsThatDoNotAgree) {
  const LogText log;
  for (int v = kCamera.height_px - 1; v >= 2; --v) {  // the right camera has tilted
    std::copy_n(pair_.right.Row(v - 2), kCamera.width_px, pair_.right.Row(v));
  }
  Start();
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(SendUntilMatched(At(1 + 3 * k)));
  EXPECT_EQ(log.Count("the rows of the two images differ by up to 2.0 px"), 1) << log.Text();
}

TEST_F(StereoServiceTest, CountsABadImageAndGoesOn) {
  Start();
  sensor_msgs::msg::Image message = Message(At(1), pair_.left);
  message.encoding("mono16");
  left_.Write(message);
  ASSERT_TRUE(Until([&] { return rejected() == 1; }));
  EXPECT_TRUE(SendUntilMatched(At(2)));
}

TEST_F(StereoServiceTest, CountsAPairThatItsMatcherRefusesAndGoesOn) {
  const test::Pair good = pair_;
  camera_.height_px = 10;  // less than the height of OpenCV's window
  pair_ = test::PlanePair(camera_.width_px, camera_.height_px, 0.0, 0.0, kDisparity, 21);
  options_.engine = "opencv-bm";
  Start();
  Time stamp = At(1);
  EXPECT_TRUE(Until([&] {
    stamp += std::chrono::milliseconds(10);
    SendInfos(stamp);
    SendPair(stamp);
    const auto health = service_bus_.health().ToMessage(stamp);
    return std::any_of(health.dropped().begin(), health.dropped().end(), [](const auto& counter) {
      return counter.last().find("matching failed") != std::string::npos;
    });
  }));
  camera_ = kCamera;
  pair_ = good;
  EXPECT_TRUE(SendUntilMatched(stamp + std::chrono::seconds(1)));
}

TEST_F(StereoServiceTest, MatchesThePairThatArrivedBeforeItsCameraInfo) {
  Start();
  camera_bus_.EveryWall(std::chrono::milliseconds(20), [this] {
    if (dropped() == 0) SendPair(At(1));
  });
  ASSERT_TRUE(Until([&] { return dropped() > 0; })) << "it has come twice";
  SendInfos(At(1));
  ASSERT_TRUE(Until([&] { return !clouds_.empty(); }));
  EXPECT_EQ(clouds_.front().stamp, At(1));
}

TEST_F(StereoServiceTest, CountsAPairOfDifferentSizes) {
  Start();
  ASSERT_TRUE(SendUntilMatched(At(1)));
  left_.Write(Message(At(10), pair_.left));
  right_.Write(Message(At(10), ByteImage(80, 120)));
  EXPECT_TRUE(Until([&] { return rejected() == 1; }));
}

TEST_F(StereoServiceTest, CountsImagesOfAnotherSizeThanTheirCalibration) {
  options_.calibration.emplace();
  for (RawCamera* camera : {&options_.calibration->left, &options_.calibration->right}) {
    camera->width_px = 320;
    camera->height_px = 240;
    camera->K << 200, 0, 160, 0, 200, 120, 0, 0, 1;
  }
  options_.calibration->T_RL.translation().x() = -0.1;
  Start();
  SendPair(At(1));
  EXPECT_TRUE(Until([&] { return rejected() == 1; }));
  EXPECT_TRUE(clouds_.empty());
}

/// The right camera is mounted 4 px too high: its images match only if r, d and k of its camera_info are
/// used.
TEST_F(StereoServiceTest, RectifiesRawImagesAsTheirCameraInfoSays) {
  constexpr int kRaised = 4;
  ByteImage raised(pair_.right.width(), pair_.right.height());
  for (int v = 0; v < raised.height(); ++v) {
    const std::uint8_t* const from = pair_.right.Row(std::max(0, v - kRaised));
    std::copy_n(from, raised.width(), raised.Row(v));
  }
  pair_.right = raised;
  right_k_ = {120.0, 0.0, 79.5, 0.0, 120.0, 59.5 + kRaised, 0.0, 0.0, 1.0};
  Start();
  ASSERT_TRUE(SendUntilMatched(At(1)));
  const PointCloud& cloud = clouds_.back().cloud;
  int good = 0;
  for (int v = 20; v < 100; ++v) {
    for (int u = 30; u < 140; ++u) good += std::abs(cloud.points_C[v * 160 + u].z() - kDepth) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(good, 80 * 110 * 9 / 10);
}

TEST_F(StereoServiceTest, FollowsACameraInfoThatChanges) {
  Start();
  ASSERT_TRUE(SendUntilMatched(At(1)));
  EXPECT_NEAR(clouds_.back().cloud.points_C[60 * 160 + 100].z(), kDepth, 0.05);
  camera_.fx = camera_.fy = 240.0;
  // Topics may overtake each other, so the first pairs may arrive before the new camera_info.
  double depth = 0.0;
  for (int attempt = 0; attempt < 10 && std::abs(depth - 2.0 * kDepth) > 0.1; ++attempt) {
    ASSERT_TRUE(SendUntilMatched(At(2 + attempt)));
    depth = clouds_.back().cloud.points_C[60 * 160 + 100].z();
  }
  EXPECT_NEAR(depth, 2.0 * kDepth, 0.1);
}

TEST_F(StereoServiceTest, SaysThatTheImagesLookSwapped) {
  std::swap(pair_.left, pair_.right);
  Start();
  ASSERT_TRUE(SendUntilMatched(At(1)));
  const auto said = [this] {
    const auto health = service_bus_.health().ToMessage(At(1));
    return std::any_of(health.dropped().begin(), health.dropped().end(),
                       [](const auto& entry) { return entry.last().find("swapped") != std::string::npos; });
  };
  EXPECT_TRUE(Until(said));
}

TEST_F(StereoServiceTest, KeepsOnlyTheNewestPairBeforeItsCameraInfoAndSaysSo) {
  Start();
  Time stamp = At(1);
  camera_bus_.EveryWall(std::chrono::milliseconds(20),
                        [&] { SendPair(stamp += std::chrono::milliseconds(10)); });
  EXPECT_TRUE(Until([this] {
    const auto health = service_bus_.health().ToMessage(At(1));
    return std::any_of(health.dropped().begin(), health.dropped().end(), [](const auto& counter) {
      return counter.last().find("no camera_info") != std::string::npos;
    });
  }));
}

TEST_F(StereoServiceTest, CountsAHalfWhoseOtherDidNotCome) {
  Start();
  Time stamp = At(1);
  camera_bus_.EveryWall(std::chrono::milliseconds(20),
                        [&] { left_.Write(Message(stamp += std::chrono::milliseconds(10), pair_.left)); });
  EXPECT_TRUE(Until([&] { return dropped() >= 1; }));
}

TEST_F(StereoServiceTest, MatchesNoMorePairsThanItIsAskedTo) {
  options_.rate = 2.0;
  Start();
  ASSERT_TRUE(SendUntilMatched(At(1)));
  const Time first = clouds_.back().stamp;
  for (const int later : {100, 200, 300, 400}) SendPair(first + std::chrono::milliseconds(later));
  ASSERT_TRUE(SendUntilMatched(first + std::chrono::milliseconds(500)));
  EXPECT_EQ(clouds_.size(), 2U);
  EXPECT_GE(clouds_.back().stamp - first, std::chrono::milliseconds(500));
}

TEST_F(StereoServiceTest, GoesOnWhenTimeBeginsAgain) {
  Start();
  ASSERT_TRUE(SendUntilMatched(At(100)));
  EXPECT_TRUE(SendUntilMatched(At(1)));
  EXPECT_LT(clouds_.back().stamp, At(50));
}

TEST(StereoServiceStart, NamesAnUnknownEngine) {
  dds::Bus bus(BusOptionsForTest("stereo"));
  StereoOptions options;
  options.engine = "none";
  EXPECT_THAT([&] { StereoService(options, bus); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("\"none\"")));
}

TEST(StereoOptionsFrom, TakesWhatTheScenarioGivesAndLeavesTheDefaults) {
  Scenario scenario;
  scenario.mutable_stereo()->set_engine("sad5-dog");
  scenario.mutable_stereo()->set_max_disparity_px(96);
  scenario.mutable_stereo()->set_max_depth_error_m(0.07);
  scenario.mutable_stereo()->set_rate_hz(2.5);
  const StereoOptions options = OptionsFrom(scenario);
  EXPECT_EQ(options.engine, "sad5-dog");
  EXPECT_EQ(options.matcher.max_disparity, 96);
  EXPECT_EQ(options.rate, 2.5);
  EXPECT_EQ(options.triangulation.max_depth_error, 0.07);
  EXPECT_EQ(options.triangulation.min_depth, TriangulationOptions{}.min_depth);
  scenario.mutable_stereo()->set_calibration_file("/nowhere.yml");
  EXPECT_THAT([&] { OptionsFrom(scenario); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("/nowhere.yml")));
}

}  // namespace
}  // namespace thalweg::stereo
