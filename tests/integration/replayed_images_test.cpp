#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "common/dds/convert.h"
#include "services/explorer/adapter/explorer_service.h"
#include "services/mapper/adapter/mapper_service.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"
#include "services/recorder/adapter/recorder.h"
#include "services/stereo/adapter/stereo_service.h"
#include "services/visual_odometry/adapter/visual_odometry_service.h"
#include "tests/services/visual_odometry/support/textured_room.h"
#include "tests/support/test_bus.h"

namespace thalweg {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""ms;
using test::BusOptionsForTest;
using test::kPatience;
using visual_odometry::StereoImages;

constexpr std::size_t kPairs = 10;
/// Between pairs, of the wall clock: longer than a pair takes on a busy machine, since who is late leaves
/// pairs out.
constexpr auto kPeriod = 250ms;

/// The bus of a participant that takes part in the flight, or in its replay.
dds::BusOptions Bus(const std::string& name, const std::string& which) {
  dds::BusOptions options = BusOptionsForTest(name);
  options.partition += "." + which;
  return options;
}

mapper::MapperOptions MappingInto(const std::filesystem::path& folder) {
  mapper::MapperOptions options;
  options.out = folder;
  options.checkpoint_period = std::chrono::hours(1);
  options.snapshot_period = std::chrono::hours(1);
  std::filesystem::create_directories(folder);
  return options;
}

/// A service on its own participant, and, once it receives what it needs, on its own thread.
template <class Service>
class Running {
 public:
  template <class... Args>
  explicit Running(const dds::BusOptions& bus, const Args&... args) : bus_(bus), service_(args..., bus_) {}

  /// Waits until each topic has a writer, so that nothing that is sent from then on is lost.
  template <class... Topics>
  void Start() {
    ASSERT_TRUE(bus_.SpinUntil([&] { return (... && (bus_.Writers<Topics>() > 0)); }, kPatience));
    thread_ = std::jthread([this](const std::stop_token& stop) { bus_.Spin(stop); });
  }

 private:
  dds::Bus bus_;
  Service service_;
  std::jthread thread_;  ///< Last, so that it is joined before the members it uses are destroyed.
};

/// All that turns images into a map and into where to go, and a listener to what it publishes.
class Onlookers {
 public:
  Onlookers(const std::string& which, const std::filesystem::path& folder)
      : bus_(Bus("listener", which)),
        stereo_(Bus("stereo", which), stereo::StereoOptions{}),
        odometry_(Bus("visual-odometry", which), visual_odometry::VisualOdometryOptions{}),
        mapper_(Bus("mapper", which), MappingInto(folder)),
        explorer_(Bus("explorer", which), explorer::Explorer::Options{}) {
    bus_.Subscribe<topics::DepthPoints>([this](const auto& message) { clouds.push_back(message); });
    bus_.Subscribe<topics::Odometry>([this](const auto& message) { poses.push_back(message); });
    bus_.Subscribe<topics::MapUpdates>([this](const auto& message) {
      if (!message.full()) updates.push_back(message.blocks());
    });
    bus_.Subscribe<topics::Frontiers>([this](const auto&) { ++plans; });
  }

  /// To be called once someone offers the images.
  void Start() {
    stereo_.Start<topics::LeftImage, topics::RightImage, topics::LeftCameraInfo, topics::RightCameraInfo>();
    odometry_.Start<topics::LeftImage, topics::RightImage, topics::LeftCameraInfo, topics::RightCameraInfo>();
    mapper_.Start<topics::DepthPoints, topics::Odometry>();
    explorer_.Start<topics::MapUpdates, topics::Odometry>();
    ASSERT_TRUE(Until([&] {
      return bus_.Writers<topics::DepthPoints>() == 1 && bus_.Writers<topics::Odometry>() == 1 &&
             bus_.Writers<topics::MapUpdates>() == 1 && bus_.Writers<topics::Frontiers>() == 1;
    }));
  }
  bool Until(const std::function<bool()>& done, Duration patience = kPatience) {
    return bus_.SpinUntil(done, patience);
  }
  void Turn() {
    bus_.SpinUntil([] { return false; }, 5ms);
  }

  std::vector<sensor_msgs::msg::PointCloud2> clouds;
  std::vector<nav_msgs::msg::Odometry> poses;
  std::vector<std::vector<thalweg_msgs::msg::MapBlock>> updates;
  int plans = 0;

 private:
  dds::Bus bus_;
  Running<stereo::StereoService> stereo_;
  Running<visual_odometry::VisualOdometryService> odometry_;
  Running<mapper::MapperService> mapper_;
  Running<explorer::ExplorerService> explorer_;
};

/// A robot that has nothing but two cameras.
class Cameras {
 public:
  explicit Cameras(dds::Bus& bus) : bus_(bus) {}

  bool HaveReaders(int each) const {
    return left_.readers() == each && right_.readers() == each && left_info_.readers() == each &&
           right_info_.readers() == each;
  }
  void Send(const StereoGeometry& rig, const StereoImages& images) const {
    left_info_.Write(dds::ToIdl(images.stamp, rig.camera, 0.0));
    right_info_.Write(dds::ToIdl(images.stamp, rig.camera, rig.baseline));
    left_.Write(Message(images.stamp, images.left));
    right_.Write(Message(images.stamp, images.right));
  }

 private:
  static sensor_msgs::msg::Image Message(Time stamp, const cv::Mat& image) {
    return dds::ToIdl(stamp, dds::kCameraFrame, image.cols, image.rows, "mono8",
                      std::vector<std::uint8_t>(image.datastart, image.dataend));
  }

  dds::Bus& bus_;
  dds::Bus::Publisher<topics::LeftImage> left_ = bus_.Advertise<topics::LeftImage>();
  dds::Bus::Publisher<topics::RightImage> right_ = bus_.Advertise<topics::RightImage>();
  dds::Bus::Publisher<topics::LeftCameraInfo> left_info_ = bus_.Advertise<topics::LeftCameraInfo>();
  dds::Bus::Publisher<topics::RightCameraInfo> right_info_ = bus_.Advertise<topics::RightCameraInfo>();
};

/// @return Whether all pairs, and all that follows from them, arrived where they should.
bool Replays(recorder::Player& player, Onlookers& onlookers) {
  std::atomic<bool> ended = false;
  const std::jthread playing([&](const std::stop_token& stop) {
    player.Run(stop);
    ended = true;
  });
  const auto is_whole = [&] {
    return onlookers.clouds.size() == kPairs && onlookers.poses.size() == kPairs &&
           onlookers.updates.size() == kPairs && onlookers.plans > 0;
  };
  while (!ended && !is_whole()) onlookers.Turn();
  return onlookers.Until(is_whole, std::chrono::seconds(2));
}

// Stereo, odometry, mapper and explorer run again from recorded images, without a robot or a simulator: the
// same clouds, poses and map, to the last bit, and a plan.
TEST(ReplayedImages, GiveTheSameCloudsPosesAndMap) {
  const std::filesystem::path folder = testing::TempDir() + "/replayed-images-" + std::to_string(getpid());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const StereoGeometry rig = visual_odometry::test::SmallRig();
  const visual_odometry::test::TexturedRoom room;
  Onlookers original("original", folder / "original");
  {
    dds::Bus robot(Bus("robot", "original"));
    const Cameras cameras(robot);
    dds::Bus recorder_bus(Bus("recorder", "original"));
    recorder::RecorderOptions options;
    options.recording.file = folder / "a.mcap";
    options.topics = {"stereo/*/image_raw", "stereo/*/camera_info"};
    recorder::Recorder recorder(options, recorder_bus);
    recorder_bus.EveryWall(5ms, [] {});  // the recorder's count is no event of the bus
    ASSERT_TRUE(robot.SpinUntil([&] { return cameras.HaveReaders(3); }, kPatience));
    ASSERT_NO_FATAL_FAILURE(original.Start());
    std::size_t sent = 0;
    robot.EveryWall(kPeriod, [&] {
      if (sent == kPairs || original.updates.size() < sent) return;
      const int step = static_cast<int>(2 * ++sent);  // 10 Hz
      cameras.Send(rig, room.SeePair(rig, visual_odometry::test::RoomPose(step),
                                     visual_odometry::test::RoomStamp(step)));
    });
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (original.updates.size() < kPairs && std::chrono::steady_clock::now() < end) {
      robot.SpinUntil([] { return false; }, 5ms);
      original.Turn();
      recorder_bus.SpinUntil([] { return false; }, 5ms);
    }
    ASSERT_TRUE(recorder_bus.SpinUntil([&] { return recorder.status().messages == 4 * kPairs; }, kPatience));
    ASSERT_EQ(original.clouds.size(), kPairs);
    ASSERT_EQ(original.poses.size(), kPairs);
    ASSERT_EQ(original.updates.size(), kPairs);
    EXPECT_TRUE(original.Until([&] { return original.plans > 0; }));
  }

  const recorder::MappedFile file(folder / "a.mcap");
  const auto reader = recorder::McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  constexpr int kAttempts = 4;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::string which = "again" + std::to_string(attempt);
    Onlookers again(which, folder / which);
    dds::Bus player_bus(Bus("replay", which));
    recorder::Player player(*reader, {.rate = 0.5}, player_bus);
    ASSERT_NO_FATAL_FAILURE(again.Start());
    ASSERT_TRUE(player.AwaitReaders(kPatience));
    if (!Replays(player, again)) continue;  // a pose is sent once, and lost on a machine that is too busy
    EXPECT_EQ(again.clouds, original.clouds);
    EXPECT_EQ(again.poses, original.poses);
    EXPECT_EQ(again.updates, original.updates);
    EXPECT_GT(again.plans, 0);
    std::filesystem::remove_all(folder);
    return;
  }
  FAIL() << "something was lost each time";
}

}  // namespace
}  // namespace thalweg
