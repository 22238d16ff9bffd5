#include "services/recorder/adapter/mapped_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

namespace thalweg::recorder {
namespace {

class MappedFileTest : public testing::Test {
 protected:
  MappedFileTest() { std::filesystem::create_directories(folder_); }
  ~MappedFileTest() override { std::filesystem::remove_all(folder_); }

  /// Why a file cannot be mapped.
  static std::string Refusal(const std::filesystem::path& file) {
    try {
      const MappedFile mapped(file);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-mapped-" + std::to_string(getpid()));
};

TEST_F(MappedFileTest, HasTheBytesOfTheFile) {
  std::ofstream(folder_ / "three") << "abc";
  std::ofstream(folder_ / "none").flush();
  EXPECT_THAT(MappedFile(folder_ / "three").bytes(), testing::ElementsAre('a', 'b', 'c'));
  EXPECT_TRUE(MappedFile(folder_ / "none").bytes().empty());
}

TEST_F(MappedFileTest, WhatIsNoFileIsRefusedAtOnce) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);  // nobody writes to it
  EXPECT_EQ(Refusal(folder_ / "pipe"),
            (folder_ / "pipe").string() + ": cannot be read: it is not a regular file");
  EXPECT_THAT(Refusal(folder_), testing::HasSubstr("Is a directory"));
  EXPECT_THAT(Refusal(folder_ / "missing"), testing::HasSubstr("No such file or directory"));
}

}  // namespace
}  // namespace thalweg::recorder
