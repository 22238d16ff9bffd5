#include "services/cli/adapter/replay_terminal.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/recording_file.h"
#include "tests/support/test_bus.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;
using dds::topics::Odometry;
using recorder::Player;

constexpr Time kBegin{1000s};

/// A player of a minute of odometry. It is not run, so that only keys change where
/// it is.
class ReplayKeys : public testing::Test {
 protected:
  ReplayKeys() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    const dds::TopicInfo odometry = dds::InfoOf<Odometry>();
    recorder::RecordingFile file(
        {.file = folder_ / "a.mcap"},
        {{.topic = "/" + odometry.name, .type = dds::Ros2TypeName(odometry.type_name)}});
    for (const Duration at : {Duration(0s), Duration(60s)}) {
      file.Write(0, 0, kBegin + at, kBegin + at, dds::Encode<Odometry>({}));
    }
    file.Close();
    file_.emplace(folder_ / "a.mcap");
    reader_.emplace(*recorder::McapReader::Open(file_->bytes()));
    player_.emplace(*reader_, recorder::PlayerOptions{.start = 20.0, .paused = true}, bus_);
  }
  ~ReplayKeys() override { std::filesystem::remove_all(folder_); }

  /// [s] Where the recording is after these keys.
  double At(const char* typed) {
    Obey(*player_, typed);
    const Player::Progress its = player_->progress();
    return Seconds(its.now - its.begin);
  }
  double Rate(const char* typed) {
    Obey(*player_, typed);
    return player_->progress().rate;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("replay_keys_" + std::to_string(getpid()));
  dds::Bus bus_{test::BusOptionsForTest("replay_keys")};
  std::optional<recorder::MappedFile> file_;
  std::optional<recorder::McapReader> reader_;
  std::optional<Player> player_;
};

TEST_F(ReplayKeys, ArrowsSeekByFiveSecondsWithinTheRecording) {
  EXPECT_EQ(At(""), 20.0);
  EXPECT_EQ(At("\x1b[C"), 25.0);
  EXPECT_EQ(At("\x1b[D\x1b[D"), 15.0);
  EXPECT_EQ(At("\x1b[D\x1b[D\x1b[D\x1b[D"), 0.0);
  for (int k = 0; k < 13; ++k) Obey(*player_, "\x1b[C");
  EXPECT_EQ(At(""), 60.0);
}

TEST_F(ReplayKeys, MinusAndPlusHalveAndDoubleTheRate) {
  EXPECT_EQ(Rate("+"), 2.0);
  EXPECT_EQ(Rate("="), 4.0) << "plus without its shift";
  EXPECT_EQ(Rate("---"), 0.5);
}

TEST_F(ReplayKeys, EnterAndSpacePauseAndGoOn) {
  Obey(*player_, "\n");
  EXPECT_FALSE(player_->progress().paused);
  Obey(*player_, " ");
  EXPECT_TRUE(player_->progress().paused);
}

TEST_F(ReplayKeys, OthersDoNothingAndKeepNoneFromItsWork) {
  EXPECT_EQ(At("\x1b[Ax\x1b[B\x1b"), 20.0);
  EXPECT_EQ(Rate("q\x1b[A+"), 2.0);
  EXPECT_TRUE(player_->progress().paused);
}

TEST(ReplayProgress, SaysWhereItIsHowFastAndWhetherItStands) {
  Player::Progress its{
      .begin = kBegin, .end = kBegin + 180s, .now = kBegin + 12s, .rate = 2.0, .paused = true};
  EXPECT_EQ(ProgressText(its), "0:12 / 3:00  2x  paused");
  its.rate = 0.25;
  its.paused = false;
  EXPECT_EQ(ProgressText(its), "0:12 / 3:00  0.25x");
}

}  // namespace
}  // namespace thalweg::cli
