#include "services/cli/process/browser.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "services/gateway/adapter/page_files.h"

namespace thalweg::cli {
namespace {

gateway::ListenOptions ListenOn(int port, const std::string& token = "") {
  gateway::ListenOptions listen;
  listen.port = port;
  listen.token = token;
  return listen;
}

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

  std::string Opened() const {
    std::ostringstream opened;
    opened << std::ifstream(folder_ / "opened").rdbuf();
    return opened.str();
  }

  const std::string path_ = std::getenv("PATH");
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-browser-" + std::to_string(getpid()));
};

TEST_F(BrowserTest, APageOpensWhereThereIsAScreen) {
  ASSERT_TRUE(HasBrowser(true));
  OpenInBrowser("http://127.0.0.1:8765/");
  EXPECT_EQ(Opened(), "http://127.0.0.1:8765/\n");
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

TEST_F(BrowserTest, TheAddressIsPrintedAndOpensUnlessItHoldsATokenOrNobodyIsThere) {
  std::ofstream(folder_ / "index.html") << "a page";
  setenv("THALWEG_PAGE", folder_.c_str(), 1);
  std::string said;
  const auto say = [&](const std::string& text) { said += text + '\n'; };
  ShowPage(ListenOn(8766, "secret"), "to see the run.", true, say);
  ShowPage(ListenOn(8767), "to see the run.", false, say);
  ShowPage(ListenOn(8768), "to see the run.", true, say);
  EXPECT_EQ(said,
            "Open http://127.0.0.1:8766/?token=secret to see the run.\n"
            "Open http://127.0.0.1:8767/ to see the run.\n"
            "Open http://127.0.0.1:8768/ to see the run.\n");
  EXPECT_EQ(Opened(), "http://127.0.0.1:8768/\n");
  unsetenv("THALWEG_PAGE");
}

TEST_F(BrowserTest, APageThatWasNotBuiltIsNotOpened) {
  setenv("THALWEG_PAGE", folder_.c_str(), 1);
  std::string said;
  ShowPage(ListenOn(8768), "to see the run.", true, [&](const std::string& text) { said += text; });
  EXPECT_EQ(said, gateway::NoPageText("http://127.0.0.1:8768/"));
  unsetenv("THALWEG_PAGE");
}

}  // namespace
}  // namespace thalweg::cli
