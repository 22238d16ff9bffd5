#include "services/cli/process/child_process.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "common/files/write_file.h"

namespace thalweg::cli {
namespace {

std::runtime_error CannotStart(const Program& program, int error) {
  return std::runtime_error("cannot start " + program.executable.string() + ": " + std::strerror(error));
}

/// Executable and arguments, as text and as execv takes them.
class CommandLine {
 public:
  explicit CommandLine(const Program& program) : words_{program.executable.string()} {
    words_.insert(words_.end(), program.arguments.begin(), program.arguments.end());
    for (std::string& word : words_) pointers_.push_back(word.data());
    pointers_.push_back(nullptr);
  }
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  const char* executable() const { return words_[0].c_str(); }
  char* const* arguments() const { return pointers_.data(); }

 private:
  std::vector<std::string> words_;
  std::vector<char*> pointers_;
};

/// Uses only functions that are safe between fork and exec in a process with threads. Never returns.
[[noreturn]] void BecomeProgram(const char* executable, char* const* arguments, int log, int report,
                                pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);  // the parent died in between
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  execv(executable, arguments);
  const int error = errno;
  [[maybe_unused]] const auto written = write(report, &error, sizeof error);
  _exit(127);
}

}  // namespace

pid_t StartProcess(const Program& program) {
  const CommandLine line(program);
  const int log = open(program.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0) throw CannotWrite(program.log, errno);
  std::array<int, 2> report{};
  if (pipe2(report.data(), O_CLOEXEC) != 0) throw CannotStart(program, errno);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) BecomeProgram(line.executable(), line.arguments(), log, report[1], parent);
  const int fork_error = errno;
  close(log);
  close(report[1]);
  int exec_error = 0;
  const bool failed = child > 0 && read(report[0], &exec_error, sizeof exec_error) == sizeof exec_error;
  close(report[0]);
  if (child < 0) throw CannotStart(program, fork_error);
  if (failed) {
    waitpid(child, nullptr, 0);
    throw CannotStart(program, exec_error);
  }
  return child;
}

void Become(const Program& program) {
  const CommandLine line(program);
  execv(line.executable(), line.arguments());
  throw CannotStart(program, errno);
}

std::string LastLines(const std::filesystem::path& log, int count) {
  constexpr std::streamoff kMost = 64 * 1024;
  std::ifstream in(log, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  if (size <= 0) return "";
  in.seekg(std::max<std::streamoff>(0, size - kMost));
  std::ostringstream rest;
  rest << in.rdbuf();
  std::string text = rest.str();
  while (text.ends_with('\n')) text.pop_back();
  std::size_t from = text.size();
  for (int k = 0; k < count && from != std::string::npos; ++k) {
    from = from == 0 ? std::string::npos : text.rfind('\n', from - 1);
  }
  return from == std::string::npos ? text : text.substr(from + 1);
}

std::string DescribeEnd(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    return "signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  }
  return "exit code " + std::to_string(WEXITSTATUS(wait_status));
}

}  // namespace thalweg::cli
