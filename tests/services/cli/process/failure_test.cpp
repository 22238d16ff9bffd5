#include "services/cli/process/failure.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;
using testing::ElementsAre;
using testing::HasSubstr;

class FailureTest : public testing::Test {
 protected:
  FailureTest() : folder_(testing::TempDir() + "/failure-" + std::to_string(getpid())) {
    std::filesystem::create_directories(folder_);
    EXPECT_EQ(mkfifo(Fifo().c_str(), 0600), 0);
  }
  ~FailureTest() override { std::filesystem::remove_all(folder_); }

  /// Starts a process that obeys SIGTERM as the script says, and waits until it does.
  void Start(Supervisor& supervisor, const std::string& name, const std::string& on_term) const {
    const std::string script = "trap '" + on_term + "' TERM; echo ready > $0; while :; do sleep 0.01; done";
    supervisor.Start({.name = name,
                      .executable = "/bin/sh",
                      .arguments = {"-c", script, Fifo()},
                      .log = folder_ / (name + ".log")});
    std::string line;
    while (line.empty()) {
      std::ifstream in(Fifo());
      std::getline(in, line);
    }
  }
  std::string Fifo() const { return folder_ / "fifo"; }

  const std::filesystem::path folder_;
};

TEST_F(FailureTest, ShowsTheLastLinesOfTheLogCleaned) {
  const std::filesystem::path log = folder_ / "mapper.log";
  {
    std::ofstream out(log);
    for (int line = 1; line <= 12; ++line) out << "line " << line << '\n';
    out << "\x1b[2J\n";
  }
  const Failure failure = FailureFrom({.what = "mapper ended with exit code 1", .log = log});
  EXPECT_EQ(failure.what, "mapper ended with exit code 1");
  EXPECT_THAT(failure.details, HasSubstr("; the last lines of " + log.string() + ":\n    line 4\n"));
  EXPECT_THAT(failure.details, testing::Not(HasSubstr("\x1b")));
}

TEST_F(FailureTest, SaysThatALogIsEmpty) {
  const std::filesystem::path log = folder_ / "mapper.log";
  EXPECT_EQ(FailureFrom({.what = "x", .log = log}).details, "; " + log.string() + " is empty");
}

TEST_F(FailureTest, WhatTheWriterOfFilesOrAnErrorCostIsDistinguishedFromOthersThatAreKilled) {
  std::vector<std::string> said;
  const auto say = [&](const std::string& line) { said.push_back(line); };
  Supervisor supervisor(OnDeath::kEndRun, say);
  Start(supervisor, "mapper", "");
  Start(supervisor, "explorer", "");
  Start(supervisor, "controller", "echo no space; exit 1");
  Start(supervisor, "simulator", "exit 0");
  const std::vector<std::string> lost = StopServices(supervisor, 1s, "mapper", say);
  EXPECT_THAT(said, ElementsAre("explorer did not stop and was killed"));
  ASSERT_EQ(lost.size(), 2U);
  EXPECT_EQ(lost[0], "mapper did not stop and was killed");
  EXPECT_THAT(lost[1], testing::AllOf(HasSubstr("controller ended with exit code 1; the last lines of"),
                                      HasSubstr("\n    no space")));
}

}  // namespace
}  // namespace thalweg::cli
