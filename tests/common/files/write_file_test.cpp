#include "common/files/write_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include "tests/support/full_disk.h"

namespace thalweg {
namespace {

namespace fs = std::filesystem;
using test::FullDisk;
using testing::AllOf;
using testing::HasSubstr;

class WriteFileTest : public testing::Test {
 protected:
  WriteFileTest() { fs::create_directories(folder_); }
  ~WriteFileTest() override { fs::remove_all(folder_); }

  static std::string TextOf(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  static std::string ErrorOf(const fs::path& file) {
    try {
      WriteFile(file, "x");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  const fs::path folder_ = fs::temp_directory_path() / ("write_file_test_" + std::to_string(getpid()));
};

TEST_F(WriteFileTest, ReplacesTheFileAndLeavesNothingBeside) {
  WriteFile(folder_ / "a", "a longer text");
  WriteFile(folder_ / "a", std::string_view("t\0o", 3));
  EXPECT_EQ(TextOf(folder_ / "a"), std::string("t\0o", 3));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(WriteFileTest, MakesTheFolder) {
  WriteFile(folder_ / "deep" / "down" / "a", "text");
  EXPECT_EQ(TextOf(folder_ / "deep" / "down" / "a"), "text");
}

TEST_F(WriteFileTest, NamesTheFileAndTheReason) {
  fs::create_directories(folder_ / "taken");
  EXPECT_EQ(ErrorOf(folder_ / "taken"), (folder_ / "taken").string() + ": cannot be written: Is a directory");
  WriteFile(folder_ / "file", "");
  EXPECT_THAT(ErrorOf(folder_ / "file" / "x"),
              AllOf(HasSubstr((folder_ / "file" / "x").string()), HasSubstr("Not a directory")));
  EXPECT_EQ(ErrorOf("/dev/full"), "/dev/full: cannot be written: No space left on device");
}

TEST_F(WriteFileTest, WritesIntoAPipeInsteadOfReplacingIt) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string come;
  {
    const std::jthread reader([&] { come = TextOf(pipe); });
    WriteFile(pipe, "text");
  }
  EXPECT_EQ(come, "text");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(WriteFileTest, WritesThroughALinkInsteadOfReplacingIt) {
  for (const bool exists : {false, true}) {
    const fs::path target = folder_ / (exists ? "old" : "new");
    if (exists) WriteFile(target, "a longer text");
    const fs::path link = folder_ / (exists ? "to_old" : "to_new");
    fs::create_symlink(target, link);
    WriteFile(link, "text");
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(TextOf(target), "text");
  }
}

TEST_F(WriteFileTest, LeavesNothingBehindWhenItFails) {
  fs::create_directories(folder_ / "taken.unfinished");  // in the way of the unfinished file
  EXPECT_THAT(ErrorOf(folder_ / "taken"), HasSubstr("Is a directory"));
  EXPECT_THROW(CheckWritable(folder_ / "taken"), std::runtime_error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(WriteFileTest, WhetherAFileIsWritableIsKnownBeforeAndChangesNothing) {
  WriteFile(folder_ / "a", "text");
  EXPECT_NO_THROW(CheckWritable(folder_ / "a"));
  EXPECT_EQ(TextOf(folder_ / "a"), "text");
  EXPECT_NO_THROW(CheckWritable(folder_ / "b"));
  EXPECT_FALSE(fs::exists(folder_ / "b"));
  EXPECT_THROW(CheckWritable(folder_), std::runtime_error);
}

TEST_F(WriteFileTest, AFileThatDoesNotFitLeavesThePreviousOneAndNothingBeside) {
  WriteFile(folder_ / "a", "whole");
  const FullDisk full(1000);
  EXPECT_THROW(WriteFile(folder_ / "a", std::string(5000, 'x')), std::runtime_error);
  EXPECT_EQ(TextOf(folder_ / "a"), "whole");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(WriteFileTest, SeparateWritesGoOnAfterOneHasFailed) {
  const FullDisk full(1000);
  SeparateWrites writes;
  writes.Try([&] { WriteFile(folder_ / "large", std::string(5000, 'x')); });
  writes.Try([&] { WriteFile(folder_ / "small", "x"); });
  writes.Try([&] { WriteFile(folder_ / "small" / "under", "x"); });
  EXPECT_TRUE(fs::exists(folder_ / "small"));
  ASSERT_EQ(writes.errors().size(), 2U);
  try {
    writes.ThrowErrors();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("large: cannot be written: File too large; "),
                                    HasSubstr("under: cannot be written: Not a directory")));
  }
  EXPECT_NO_THROW(SeparateWrites().ThrowErrors());
}

TEST_F(WriteFileTest, WhetherAFolderIsWritableIsKnownBeforeAndLeavesNothingInIt) {
  EXPECT_NO_THROW(CheckFolderWritable(folder_ / "new" / "deep"));
  EXPECT_TRUE(fs::is_empty(folder_ / "new" / "deep"));
  WriteFile(folder_ / "file", "");
  for (const fs::path& folder : {folder_ / "file", folder_ / "file" / "x"}) {
    try {
      CheckFolderWritable(folder);
      FAIL() << folder;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), folder.string() + ": cannot be written: Not a directory");
    }
  }
  EXPECT_THROW(CheckWritable({folder_ / "good", fs::path(), folder_ / "file" / "x"}), std::runtime_error);
}

}  // namespace
}  // namespace thalweg
