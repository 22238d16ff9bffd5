#include "services/cli/process/browser.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace thalweg::cli {
namespace {

/// A machine with a display and an xdg-open that says through a pipe what it was asked to open.
class BrowserTest : public testing::Test {
 protected:
  BrowserTest() {
    std::filesystem::create_directories(folder_);
    mkfifo((folder_ / "opened").c_str(), 0600);
    std::ofstream(folder_ / "xdg-open")
        << "#!/bin/sh\necho \"$@\" > " << (folder_ / "opened").string() << "\n";
    std::filesystem::permissions(folder_ / "xdg-open", std::filesystem::perms::owner_all);
    setenv("PATH", folder_.c_str(), 1);
    setenv("DISPLAY", ":0", 1);
    for (const char* const name : {"WAYLAND_DISPLAY", "SSH_CONNECTION", "SSH_TTY"}) unsetenv(name);
  }
  ~BrowserTest() override {
    setenv("PATH", path_.c_str(), 1);
    unsetenv("DISPLAY");
    std::filesystem::remove_all(folder_);
  }

  const std::string path_ = std::getenv("PATH");
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-browser-" + std::to_string(getpid()));
};

TEST_F(BrowserTest, APageOpensWhereThereIsAScreen) {
  ASSERT_TRUE(HasBrowser(true));
  OpenInBrowser("http://127.0.0.1:8765/");
  std::string opened;
  std::getline(std::ifstream(folder_ / "opened"), opened);
  EXPECT_EQ(opened, "http://127.0.0.1:8765/");
}

TEST_F(BrowserTest, NoneOpensForAProgramOverSshWithoutADisplayOrWithoutABrowser) {
  EXPECT_FALSE(HasBrowser(false));
  setenv("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22", 1);
  EXPECT_FALSE(HasBrowser(true));
  unsetenv("SSH_CONNECTION");
  unsetenv("DISPLAY");
  EXPECT_FALSE(HasBrowser(true));
  setenv("WAYLAND_DISPLAY", "wayland-0", 1);
  EXPECT_TRUE(HasBrowser(true));
  std::filesystem::remove(folder_ / "xdg-open");
  EXPECT_FALSE(HasBrowser(true));
  OpenInBrowser("http://127.0.0.1:8765/");  // fails in silence
  unsetenv("WAYLAND_DISPLAY");
}

}  // namespace
}  // namespace thalweg::cli
