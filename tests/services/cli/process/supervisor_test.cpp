#include "services/cli/process/supervisor.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

class SupervisorTest : public testing::Test {
 protected:
  SupervisorTest() : folder_(testing::TempDir() + "/supervisor-" + std::to_string(getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    EXPECT_EQ(mkfifo(Fifo().c_str(), 0600), 0);
  }
  ~SupervisorTest() override { std::filesystem::remove_all(folder_); }

  /// A shell script; the test can wait for what it writes to $0.
  Program Shell(const std::string& script) const {
    return {.name = "worker", .executable = "/bin/sh", .arguments = {"-c", script, Fifo()}, .log = Log()};
  }
  std::string Fifo() const { return folder_ / "fifo"; }
  std::string Log() const { return folder_ / "worker.log"; }

  /// Blocks until a line is written.
  std::string ReadLine() const {
    std::string line;
    while (line.empty()) {  // opened before the writer of the last line had closed it, there is none to read
      std::ifstream in(Fifo());
      std::getline(in, line);
    }
    return line;
  }
  std::string LogText() const {
    std::ostringstream text;
    text << std::ifstream(Log()).rdbuf();
    return text.str();
  }
  std::function<void(const std::string&)> Collect() {
    return [this](const std::string& line) { lines_.push_back(line); };
  }

  std::filesystem::path folder_;
  std::vector<std::string> lines_;
};

/// Blocks until the process has ended, whoever its parent is.
bool WaitForEnd(pid_t pid) {
  const int fd = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  if (fd < 0) return true;  // it has ended already
  pollfd ended{.fd = fd, .events = POLLIN, .revents = 0};
  const bool yes = poll(&ended, 1, 10'000) == 1;
  close(fd);
  return yes;
}

std::optional<Death> WatchUntilFailure(Supervisor& supervisor) {
  const auto limit = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < limit) {
    if (auto failure = supervisor.Watch()) return failure;
    poll(nullptr, 0, 1);
  }
  return std::nullopt;
}

TEST_F(SupervisorTest, AProcessThatWasKilledBeforeItWasAskedToStopIsNamed) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  supervisor.Start(Shell("echo $$ > $0; kill -KILL $$"));
  const std::string pid = ReadLine();
  siginfo_t ended{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(std::stoi(pid)), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(supervisor.Stop(10s).empty());
  ASSERT_EQ(supervisor.failed_to_stop().size(), 1U);
  EXPECT_EQ(supervisor.failed_to_stop()[0].what, "worker ended with signal 9 (Killed)");
}

TEST_F(SupervisorTest, AProcessThatEndsWithAnErrorWhenAskedToStopIsNamed) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  supervisor.Start(
      Shell("trap 'echo the map is lost; exit 1' TERM; echo ready > $0; while :; do sleep 0.01; done"));
  EXPECT_EQ(ReadLine(), "ready");
  Program good = Shell("trap 'exit 0' TERM; echo ready > $0; while :; do sleep 0.01; done");
  good.name = "other";
  supervisor.Start(good);
  EXPECT_EQ(ReadLine(), "ready");
  EXPECT_TRUE(supervisor.Stop(10s).empty());
  ASSERT_EQ(supervisor.failed_to_stop().size(), 1U);
  EXPECT_EQ(supervisor.failed_to_stop()[0].what, "worker ended with exit code 1");
  EXPECT_EQ(supervisor.failed_to_stop()[0].log, Log());
  EXPECT_EQ(LastLines(Log(), 1), "the map is lost");
}

TEST_F(SupervisorTest, ProgramGetsItsArgumentsAndBothStreamsGoToTheLog) {
  Program program = Shell("echo \"$1\"; echo trouble >&2; echo end > $0");
  program.arguments.push_back("two words");
  Supervisor supervisor(OnDeath::kKeepGoing, Collect());
  supervisor.Start(program);
  EXPECT_EQ(ReadLine(), "end");
  EXPECT_EQ(LogText(), "two words\ntrouble\n");
}

TEST_F(SupervisorTest, ProgramThatIsNotThereIsNamed) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  Program program = Shell("");
  program.executable = "/nowhere/thalweg-mapper";
  try {
    supervisor.Start(program);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/thalweg-mapper: No such file"), std::string::npos);
  }
}

TEST_F(SupervisorTest, UnexpectedEndIsTheFailureWithNameAndExitCode) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  supervisor.Start(Shell("exit 3"));
  const auto failure = WatchUntilFailure(supervisor);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->what, "worker ended with exit code 3");
  EXPECT_EQ(failure->log, Log());
}

TEST_F(SupervisorTest, SignalIsNamed) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  supervisor.Start(Shell("kill -9 $$"));
  const auto failure = WatchUntilFailure(supervisor);
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->what.find("signal 9 (Killed)"), std::string::npos) << failure->what;
}

TEST_F(SupervisorTest, RespawnsFiveTimesAndThenGivesUp) {
  Supervisor supervisor(OnDeath::kRespawn, Collect());
  supervisor.Start(Shell("echo here; exit 1"));
  EXPECT_TRUE(WatchUntilFailure(supervisor));
  ASSERT_EQ(lines_.size(), 5U);
  EXPECT_EQ(lines_[4], "worker ended with exit code 1; restarted (5 of 5), see " + Log());
  EXPECT_EQ(LogText(), "here\nhere\nhere\nhere\nhere\nhere\n");
}

TEST_F(SupervisorTest, WhatTheRunDoesNotDependOnIsRestartedFiveTimesWhenItIsKilled) {
  Supervisor supervisor(OnDeath::kRespawnIfKilled, Collect());
  supervisor.Start(Shell("kill -9 $$"));
  while (lines_.size() < 6) ASSERT_FALSE(supervisor.Watch());
  EXPECT_EQ(lines_[4], "worker ended with signal 9 (Killed); restarted (5 of 5), see " + Log());
  EXPECT_EQ(lines_[5], "worker ended with signal 9 (Killed); continuing without it, see " + Log());
}

TEST_F(SupervisorTest, WhatTheRunDoesNotDependOnIsNotRestartedWhenItEndsByItself) {
  Supervisor supervisor(OnDeath::kRespawnIfKilled, Collect());
  supervisor.Start(Shell("echo one; echo the port is in use; exit 1"));
  while (lines_.empty()) ASSERT_FALSE(supervisor.Watch());
  EXPECT_EQ(lines_[0],
            "worker ended with exit code 1: the port is in use; continuing without it, see " + Log());
}

TEST_F(SupervisorTest, AProgramThatCannotBeRestartedEndsTheRunAndIsNamed) {
  const std::filesystem::path program = folder_ / "sh";
  std::filesystem::copy_file("/bin/sh", program);
  Program worker = Shell("rm -- '" + program.string() + "'; exit 1");
  worker.executable = program;
  Supervisor supervisor(OnDeath::kRespawn, Collect());
  supervisor.Start(worker);
  const auto death = WatchUntilFailure(supervisor);
  ASSERT_TRUE(death);
  EXPECT_EQ(death->what.find("worker ended with exit code 1 and cannot be restarted: "), 0U) << death->what;
  EXPECT_NE(death->what.find(program.string()), std::string::npos) << death->what;
}

TEST_F(SupervisorTest, TheRunGoesOnWithoutAProgramThatIsExpendable) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  Program expendable = Shell("exit 1");
  expendable.expendable = true;
  supervisor.Start(expendable);
  supervisor.Start(Shell("read line < $0; exit 2"));
  EXPECT_FALSE(supervisor.Watch());
  while (lines_.empty()) EXPECT_FALSE(supervisor.Watch());
  EXPECT_EQ(lines_[0], "worker ended with exit code 1; continuing without it, see " + Log());
  ASSERT_EQ(supervisor.done_without().size(), 1U);
  EXPECT_EQ(supervisor.done_without()[0].what, "worker ended with exit code 1");
  std::ofstream(Fifo()) << "end\n";
  EXPECT_TRUE(WatchUntilFailure(supervisor));
}

TEST_F(SupervisorTest, LastLinesOfALogAreThoseAtItsEnd) {
  const auto last = [this](const std::string& text, int count) {
    std::ofstream(Log()) << text;
    return LastLines(Log(), count);
  };
  EXPECT_EQ(last("one\ntwo\nthree\n", 2), "two\nthree");
  EXPECT_EQ(last("one\ntwo\nthree", 1), "three");
  EXPECT_EQ(last("one\ntwo\n", 2), "one\ntwo");
  EXPECT_EQ(last("one\ntwo\n", 9), "one\ntwo");
  EXPECT_EQ(last("\none\n\n", 2), "\none");
  EXPECT_EQ(last("", 3), "");
  EXPECT_EQ(last(std::string(1'000'000, 'x') + "\nend\n", 1), "end");
  EXPECT_EQ(LastLines(folder_ / "no.log", 3), "");
}

TEST_F(SupervisorTest, ChildrenHaveTheirOwnProcessGroupAndNoBlockedSignals) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigset_t before;
  pthread_sigmask(SIG_BLOCK, &set, &before);
  const pid_t child = StartProcess(Shell("echo ready > $0; exec sleep 1000"));
  EXPECT_EQ(ReadLine(), "ready");
  EXPECT_EQ(getpgid(child), child);
  kill(child, SIGTERM);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(DescribeEnd(status), "signal 15 (Terminated)");
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST_F(SupervisorTest, StopsPolitelyFirst) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  supervisor.Start(Shell("trap 'echo bye; exit 0' TERM; echo ready > $0; while :; do sleep 0.01; done"));
  EXPECT_EQ(ReadLine(), "ready");
  EXPECT_TRUE(supervisor.Stop(10s).empty());
  EXPECT_EQ(LogText(), "bye\n");
}

TEST_F(SupervisorTest, StopKillsWhatDoesNotListen) {
  Supervisor supervisor(OnDeath::kEndRun, Collect());
  supervisor.Start(Shell("trap '' TERM; echo ready > $0; while :; do sleep 0.01; done"));
  EXPECT_EQ(ReadLine(), "ready");
  EXPECT_EQ(supervisor.Stop(50ms), std::vector<std::string>{"worker"});
}

TEST_F(SupervisorTest, ChildrenEndWhenTheirParentIsKilled) {
  const pid_t parent = fork();
  if (parent == 0) {
    StartProcess(Shell("echo $$ > $0; exec sleep 1000"));
    pause();
    _exit(0);
  }
  const pid_t grandchild = std::stoi(ReadLine());
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_TRUE(WaitForEnd(grandchild));
}

}  // namespace
}  // namespace thalweg::cli
