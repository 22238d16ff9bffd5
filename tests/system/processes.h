#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/dds/bus.h"
#include "services/cli/process/child_process.h"
#include "tests/support/places.h"

namespace thalweg::test {

/// Isolates a test's processes and participants, and gives it a folder for its files, which the destructor removes
/// when all processes have ended: those as well that a killed `thalweg` has left behind, and that still write there.
class OwnPlace {
 public:
  OwnPlace()
      : partition_(std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "-" +
                   std::to_string(getpid())),
        folder_(testing::TempDir() + "/" + partition_) {
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    setenv("THALWEG_DOMAIN", std::to_string(domain_).c_str(), 1);
    setenv("THALWEG_PARTITION", partition_.c_str(), 1);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~OwnPlace() {
    while (wait(nullptr) > 0 || errno == EINTR) {}
    std::error_code ignored;
    if (!testing::Test::HasFailure()) std::filesystem::remove_all(folder_, ignored);
  }
  OwnPlace(const OwnPlace&) = delete;
  OwnPlace& operator=(const OwnPlace&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  int domain() const { return domain_; }

  /// With THALWEG_SECURITY, which the processes follow as well, the test has the rights of an operator.
  dds::BusOptions BusOptions() const {
    dds::BusOptions options;
    options.name = "test";
    if (const char* const keys = std::getenv("THALWEG_SECURITY"); keys != nullptr && *keys != '\0') {
      options.name = "operator";
      options.security_dir = keys;
    }
    options.domain = domain_;
    options.partition = partition_;
    options.publish_health = false;
    return options;
  }

 private:
  /// Derived from the test's name, since `thalweg run` refuses a domain in which another run is active.
  static int DomainOf(const std::string& test) {
    constexpr int kFirst = 64;
    constexpr std::uint64_t kCount = 160;
    return kFirst + static_cast<int>(HashOf(test) % kCount);
  }

  int domain_ = DomainOf(testing::UnitTest::GetInstance()->current_test_info()->name());
  std::string partition_;
  std::filesystem::path folder_;
};

/// A running program of the project, killed by the destructor at the latest.
class RunningProgram {
 public:
  RunningProgram(const std::string& executable, std::vector<std::string> arguments,
                 const std::filesystem::path& log)
      : pid_(cli::StartProcess({.name = executable,
                                .executable = std::filesystem::path(BinFolder()) / executable,
                                .arguments = std::move(arguments),
                                .log = log})),
        pidfd_(static_cast<int>(syscall(SYS_pidfd_open, pid_, 0))) {}
  ~RunningProgram() {
    Kill(SIGKILL);
    WaitForEnd(std::chrono::seconds(10));
    close(pidfd_);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  pid_t pid() const { return pid_; }
  void Kill(int signal) const {
    if (!status_) kill(pid_, signal);
  }
  bool ended() { return WaitForEnd(Duration(0)).has_value(); }

  /// Returns its status as given by waitpid; nothing if it still runs after `limit`.
  std::optional<int> WaitForEnd(Duration limit) {
    pollfd end{.fd = pidfd_, .events = POLLIN, .revents = 0};
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(limit).count();
    if (!status_ && poll(&end, 1, static_cast<int>(ms)) == 1) {
      int status = 0;
      if (waitpid(pid_, &status, 0) == pid_) status_ = status;
    }
    return status_;
  }

 private:
  pid_t pid_;
  int pidfd_;
  std::optional<int> status_;
};

}  // namespace thalweg::test
