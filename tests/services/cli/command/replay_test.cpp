// `thalweg replay` as typed by a user; what it plays is in record_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <chrono>

#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/recording_file.h"
#include "tests/support/outcome.h"
#include "tests/support/places.h"
#include "tests/support/test_bus.h"
#include "tests/system/processes.h"

namespace thalweg::cli {
namespace {

using test::Outcome;
using testing::HasSubstr;

using std::chrono_literals::operator""s;

/// An interactive shell with job control, at a terminal of its own.
class Shell {
 public:
  Shell() : pid_(forkpty(&terminal_, nullptr, nullptr, nullptr)) {
    if (pid_ != 0) return;
    execlp("bash", "bash", "--norc", "--noediting", "-i", nullptr);
    _exit(127);
  }
  ~Shell() {
    close(terminal_);  // hangs up, by which the shell ends its jobs and itself
    waitpid(pid_, nullptr, 0);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  void Type(const std::string& keys) const {
    ASSERT_EQ(write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  /// Waits until the terminal has shown this.
  bool Shows(const std::string& text) {
    const auto deadline = std::chrono::steady_clock::now() + test::kPatience;
    while (shown_.find(text) == std::string::npos) {
      constexpr int kTurnMs = 100;
      pollfd out{.fd = terminal_, .events = POLLIN, .revents = 0};
      if (std::chrono::steady_clock::now() > deadline) return false;
      if (poll(&out, 1, kTurnMs) <= 0) continue;
      std::array<char, 4096> part{};
      const ssize_t count = read(terminal_, part.data(), part.size());
      if (count <= 0) return false;
      shown_.append(part.data(), static_cast<std::size_t>(count));
    }
    return true;
  }
  const std::string& shown() const { return shown_; }

 private:
  int terminal_ = -1;
  std::string shown_;
  pid_t pid_;
};

/// A recording of a second, and the shell in which it is played.
class ReplayAtATerminal : public testing::Test {
 protected:
  ReplayAtATerminal() {
    const dds::TopicInfo odometry = dds::InfoOf<dds::topics::Odometry>();
    recorder::RecordingFile file(
        {.file = place_.folder() / "a.mcap"},
        {{.topic = "/" + odometry.name, .type = dds::Ros2TypeName(odometry.type_name)}});
    for (const Time at : {Time{1000s}, Time{1001s}})
      file.Write(0, 0, at, at, dds::Encode<dds::topics::Odometry>({}));
    file.Close();
  }
  std::string Command(const std::string& options) const {
    return test::BinFolder() + "/thalweg replay " + (place_.folder() / "a.mcap").string() + " --rate 10 " +
           options;
  }

  test::OwnPlace place_;
  Shell shell_;
};

TEST_F(ReplayAtATerminal, InTheBackgroundItPlaysOnToItsEnd) {
  shell_.Type(Command("& wait $!; echo code $?\n"));
  EXPECT_TRUE(shell_.Shows("\ncode ")) << shell_.shown();
  EXPECT_TRUE(shell_.Shows("\ncode 0")) << shell_.shown();
  EXPECT_THAT(shell_.shown(), testing::Not(HasSubstr("Stopped")));
}

TEST_F(ReplayAtATerminal, OnceInTheForegroundItObeysTheKeys) {
  shell_.Type(Command("--pause &\n"));
  ASSERT_TRUE(shell_.Shows("in the foreground: ")) << shell_.shown();
  ASSERT_TRUE(shell_.Shows("Enter begins")) << shell_.shown();
  shell_.Type("fg; echo code $?\n");
  shell_.Type("\n");
  EXPECT_TRUE(shell_.Shows("messages; late by")) << shell_.shown();
  EXPECT_TRUE(shell_.Shows("\ncode 0")) << shell_.shown();
}

Outcome Replay(const std::string& arguments) {
  return test::OutcomeOf(test::BinFolder() + "/thalweg replay " + arguments);
}

TEST(ReplayCommand, APauseThatNobodyCouldEndIsRefused) {
  const Outcome outcome = Replay("--pause none.mcap");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("standard input is no terminal"));
}

TEST(ReplayCommand, MistakesAreNamed) {
  EXPECT_THAT(Replay("none.mcap").text, HasSubstr("none.mcap"));
  for (const char* const pair : {"odometry", ":=b", "a:="}) {
    const Outcome outcome = Replay(std::string("none.mcap --remap ") + pair);
    EXPECT_EQ(outcome.exit_code, 1) << pair;
    EXPECT_THAT(outcome.text, HasSubstr(std::string("--remap ") + pair + ": must be RECORDED:=PLAYED"));
  }
}

}  // namespace
}  // namespace thalweg::cli
