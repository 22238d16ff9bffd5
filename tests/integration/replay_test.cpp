#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "common/base/text.h"
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

/// Plays a recording. Returns whether `mapper` took every cloud of it.
bool TakesAll(recorder::Player& player, const mapper::MapperService& mapper, dds::Bus& bus) {
  std::atomic<bool> ended = false;
  const std::jthread playing([&](const std::stop_token& stop) {
    player.Run(stop);
    ended = true;
  });
  const auto has_all = [&] { return mapper.updates() == kScans; };
  while (!ended && !has_all()) bus.SpinUntil(has_all, std::chrono::milliseconds(20));
  return bus.SpinUntil(has_all, std::chrono::seconds(2));
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

  const recorder::MappedFile file(folder / "a.mcap");
  const auto reader = recorder::McapReader::Open(file.bytes());
  ASSERT_TRUE(reader);
  EXPECT_GT(mapper.grid().block_count(), 50U);
  // A mapper that is late takes the newest cloud and leaves others out: then once more, and slower.
  for (const double rate : {0.1, 0.05, 0.02, 0.01}) {
    const std::string which = "again-" + NumberText(rate);
    dds::BusOptions again = BusOptionsForTest("again");
    again.partition += "." + which;
    dds::Bus fresh_bus(again);
    mapper::MapperService fresh(OptionsIn(folder / which), fresh_bus);
    dds::Bus player_bus(again);
    recorder::Player player(*reader, {.rate = rate}, player_bus);
    ASSERT_TRUE(player.AwaitReaders(kPatience));
    AwaitWriters(fresh_bus);
    if (!TakesAll(player, fresh, fresh_bus)) continue;
    EXPECT_TRUE(fresh.grid().SameAs(mapper.grid()));
    std::filesystem::remove_all(folder);
    return;
  }
  FAIL() << "a cloud was left out each time";
}

}  // namespace
}  // namespace thalweg
