#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "common/dds/convert.h"
#include "services/mapper/adapter/mapper_service.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"
#include "services/recorder/adapter/recorder.h"
#include "tests/support/analytic_room.h"
#include "tests/support/test_bus.h"

namespace thalweg {
namespace {

namespace topics = dds::topics;
using test::BusOptionsForTest;
using test::kPatience;

constexpr int kScans = 12;

RigidTransform PoseOfScan(int scan) {
  return MakeTransform(RotationFromYawPitch(0.4 * scan, 0.0), {-1.5 + 0.2 * scan, 0.1, 0.0});
}

mapper::MapperOptions OptionsIn(const std::filesystem::path& folder) {
  mapper::MapperOptions options;
  options.out = folder;
  options.checkpoint_period = std::chrono::hours(1);
  options.snapshot_period = std::chrono::hours(1);
  std::filesystem::create_directories(folder);
  return options;
}

/// Waits until a mapper's readers on `bus` are matched with the writers of another bus.
void AwaitWriters(dds::Bus& bus) {
  ASSERT_TRUE(bus.SpinUntil(
      [&] { return bus.Writers<topics::Odometry>() > 0 && bus.Writers<topics::DepthPoints>() > 0; },
      kPatience));
}

// What a mapper made of a robot's clouds and poses, another makes of their recording, to the last bit.
TEST(Replay, RecordedCloudsAndPosesGiveTheSameMap) {
  const std::filesystem::path folder = testing::TempDir() + "/replay-" + std::to_string(getpid());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  dds::BusOptions original = BusOptionsForTest("robot");
  original.partition += ".original";
  dds::Bus mapper_bus(original);
  mapper::MapperService mapper(OptionsIn(folder / "original"), mapper_bus);
  {
    dds::Bus robot(original);
    const auto poses = robot.Advertise<topics::Odometry>();
    const auto points = robot.Advertise<topics::DepthPoints>();
    dds::Bus recorder_bus(original);
    recorder::RecorderOptions options;
    options.recording.file = folder / "a.mcap";
    options.topics = {topics::Odometry::kName, topics::DepthPoints::kName};
    recorder::Recorder recorder(options, recorder_bus);
    recorder_bus.EveryWall(std::chrono::milliseconds(5),
                           [] {});  // the recorder's count is no event of the bus
    ASSERT_TRUE(robot.SpinUntil([&] { return poses.readers() == 2 && points.readers() == 2; }, kPatience));
    AwaitWriters(mapper_bus);
    AwaitWriters(recorder_bus);
    for (int scan = 0; scan < kScans; ++scan) {
      const Time stamp{std::chrono::milliseconds(100 * (scan + 1))};
      const RigidTransform T_WC = PoseOfScan(scan) * mapper::MapperOptions{}.T_BC;
      poses.Write(dds::OdometryToIdl(stamp, PoseOfScan(scan), {0, 0, 0}, {0, 0, 0}));
      points.Write(dds::ToIdl(
          stamp, test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(40, 30, 1.3), T_WC)));
      const auto scans = static_cast<std::uint64_t>(scan + 1);
      ASSERT_TRUE(mapper_bus.SpinUntil([&] { return mapper.updates() == scans; }, kPatience));
      ASSERT_TRUE(recorder_bus.SpinUntil([&] { return recorder.status().messages == 2 * scans; }, kPatience));
    }
  }

  dds::BusOptions again = BusOptionsForTest("again");
  again.partition += ".again";
  dds::Bus fresh_bus(again);
  mapper::MapperService fresh(OptionsIn(folder / "fresh"), fresh_bus);
  dds::Bus player_bus(again);
  const recorder::MappedFile file(folder / "a.mcap");
  const auto reader = recorder::McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  // Slowly, since a mapper that is late takes the newest cloud and leaves others out.
  recorder::Player player(*reader, {.rate = 0.05}, player_bus);
  ASSERT_TRUE(player.AwaitReaders(kPatience));
  AwaitWriters(fresh_bus);
  {
    const std::jthread playing([&] { player.Run({}); });
    EXPECT_TRUE(fresh_bus.SpinUntil([&] { return fresh.updates() == kScans; }, kPatience));
  }
  EXPECT_GT(mapper.grid().block_count(), 50U);
  EXPECT_TRUE(fresh.grid().SameAs(mapper.grid()));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace thalweg
