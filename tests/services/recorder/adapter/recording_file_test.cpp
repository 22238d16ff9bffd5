#include "services/recorder/adapter/recording_file.h"

#include <gmock/gmock.h>

#include <fstream>
#include <stdexcept>

#include "tests/services/recorder/support/recordings.h"

namespace thalweg::recorder {
namespace {

using test::OpenRecording;
using RecordingFileTest = test::ScratchFolder;

TEST_F(RecordingFileTest, AnOldPartOfASplitRecordingIsAnErrorAtTheBeginning) {
  for (const char* const name : {"a_x.mcap", "a_.mcap", "b_3.mcap", "a_3.txt"}) std::ofstream(folder_ / name);
  const RecordingOptions options{.file = folder_ / "a.mcap", .split_bytes = 1};
  EXPECT_NO_THROW(RecordingFile(options, {}));
  std::filesystem::remove(folder_ / "a_0.mcap");
  std::ofstream(folder_ / "a_3.mcap");
  try {
    RecordingFile(options, {});
    ADD_FAILURE() << "it would end with its fourth file";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), (folder_ / "a_3.mcap").string() + ": cannot be written: File exists");
  }
}

TEST_F(RecordingFileTest, AFolderThatDoesNotExistIsNotCreatedButNamed) {
  const std::filesystem::path file = folder_ / "mistyped" / "a.mcap";
  for (const std::uint64_t split_bytes : {0, 1}) {
    try {
      RecordingFile({.file = file, .split_bytes = split_bytes}, {});
      ADD_FAILURE() << "it was created";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(),
                file.string() + ": cannot be written: there is no folder " + (folder_ / "mistyped").string());
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "mistyped"));
  }
}

TEST_F(RecordingFileTest, ARecordingSplitByTimeHasAFileForEachSpanOfLogTimes) {
  const std::vector<std::uint8_t> bytes(10);
  const auto at = [](int seconds) { return Time{std::chrono::seconds(seconds)}; };
  RecordingFile file({.file = folder_ / "a.mcap", .split_after = std::chrono::seconds(10)},
                     {{.topic = "/a", .type = "nav_msgs/msg/Odometry"}});
  // A file spans less than 10 s, counted from its own first message, and a long silence is skipped.
  for (const int seconds : {100, 105, 109, 110, 119, 150}) file.Write(0, 0, at(seconds), at(seconds), bytes);
  file.Close();
  std::vector<std::vector<Time>> times;
  for (const std::filesystem::path& name : file.files()) {
    const OpenRecording part(name);
    EXPECT_TRUE(part.reader.Check().empty()) << name;
    MessageCursor cursor = part.reader.Read();
    times.emplace_back();
    while (const auto message = cursor.Next()) times.back().push_back(message->log_time);
  }
  const std::vector<std::vector<Time>> expected = {
      {at(100), at(105), at(109)}, {at(110), at(119)}, {at(150)}};
  EXPECT_EQ(times, expected);
  EXPECT_EQ(file.files().back(), folder_ / "a_2.mcap");
}

}  // namespace
}  // namespace thalweg::recorder
