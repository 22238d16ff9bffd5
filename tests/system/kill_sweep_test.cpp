#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "services/surface/adapter/surface_service.h"
#include "services/surface/adapter/volume_file.h"
#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

class RunWithAKill : public RunSystemTest {
 protected:
  /// Counts events of the bus instead of time, so that each attempt kills the service at another point of its
  /// work.
  bool UntilARandomMoment(int seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    int events_left = std::uniform_int_distribution<int>(0, 20)(random);
    return Until([&] { return --events_left < 0; });
  }
};

/// Which service is killed, and the number of the attempt.
class KillSweep : public RunWithAKill, public testing::WithParamInterface<std::tuple<const char*, int>> {};

TEST_P(KillSweep, RunIsCompletedAlthoughAServiceIsKilledAtARandomMoment) {
  const auto& [service, seed] = GetParam();
  Start({"--respawn", "--set", "mapper.checkpoint_period_s=1"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  const pid_t pid = PidOf(service);
  ASSERT_TRUE(UntilARandomMoment(seed)) << Printed();
  kill(pid, SIGKILL);
  ExpectComplete();
}

INSTANTIATE_TEST_SUITE_P(Services, KillSweep,
                         testing::Combine(testing::Values("explorer", "mapper", "controller"),
                                          testing::Range(0, 15)),
                         [](const auto& parameter) {
                           return std::string(std::get<0>(parameter.param)) + "_" +
                                  std::to_string(std::get<1>(parameter.param));
                         });

/// The number of the attempt.
class SurfaceKillSweep : public RunWithAKill, public testing::WithParamInterface<int> {
 protected:
  SurfaceKillSweep() {
    bus_.Subscribe<dds::topics::SurfaceStatus>([this](const auto& message) { status_ = message; });
  }
  std::filesystem::path Checkpoint() const { return Out() / surface::SurfaceService::kCheckpointFile; }
  /// Nothing if it cannot be read, or there is none.
  std::optional<surface::TruncatedVolume> Stored() const {
    auto loaded = surface::LoadVolume(Checkpoint());
    if (!loaded || !loaded->has_value()) return std::nullopt;
    return std::move((*loaded)->volume);
  }
  std::string Log() const {
    std::ostringstream log;
    log << std::ifstream(Out() / "surface.log").rdbuf();
    return log.str();
  }
  /// How many blocks the service went on from, by its log.
  std::optional<std::size_t> ResumedBlocks() const {
    std::smatch match;
    const std::string text = Log();
    if (!std::regex_search(text, match, std::regex("resuming from .* with ([0-9]+) blocks")))
      return std::nullopt;
    return std::stoul(match[1]);
  }

  std::optional<thalweg_msgs::msg::SurfaceStatus> status_;
};

TEST_P(SurfaceKillSweep, RunIsCompletedAlthoughItsSurfaceIsKilledAndItGoesOnFromItsCheckpoint) {
  // At its usual speed the exploration may end before the service has come back.
  Start({"--surface", "--respawn", "--set", "surface.checkpoint_period_s=0.1", "--set",
         "simulator.time_scale=2"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  const pid_t pid = PidOf("surface");
  ASSERT_TRUE(Until([this] { return std::filesystem::exists(Checkpoint()); })) << Printed();
  ASSERT_TRUE(UntilARandomMoment(GetParam())) << Printed();
  const std::optional<surface::TruncatedVolume> before = Stored();
  ASSERT_TRUE(before);
  kill(pid, SIGKILL);
  ASSERT_TRUE(Until([this] { return ResumedBlocks().has_value(); })) << Printed();
  EXPECT_GE(*ResumedBlocks(), before->block_count());
  status_.reset();
  ASSERT_TRUE(Until([this] { return status_ && status_->scans() > 0; })) << "it fuses no more; " << Printed();
  ExpectComplete();
  EXPECT_NE(Printed().find("surface ended with signal 9 (Killed); restarted (1 of 5)"), std::string::npos)
      << Printed();

  const std::optional<surface::TruncatedVolume> after = Stored();
  ASSERT_TRUE(after);
  std::size_t lost = 0;
  before->ForEachBlock([&](const VoxelIndex& index, const auto&) { lost += after->Find(index) == nullptr; });
  EXPECT_EQ(lost, 0U) << "of the " << before->block_count() << " blocks from before the kill";
  const std::filesystem::path mesh = Out() / surface::SurfaceService::kMeshFile;
  ASSERT_TRUE(std::filesystem::exists(mesh)) << Log() << Printed();
  EXPECT_GT(std::filesystem::file_size(mesh), 100'000U);
}

INSTANTIATE_TEST_SUITE_P(Few, SurfaceKillSweep, testing::Range(0, 2));
INSTANTIATE_TEST_SUITE_P(Many, SurfaceKillSweep, testing::Range(2, 15));

}  // namespace
}  // namespace thalweg::test
