#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace thalweg::cli {

/// A program to be run.
struct Program {
  std::string name;  ///< For people.
  std::filesystem::path executable;
  std::vector<std::string> arguments;
  std::filesystem::path log;  ///< stdout and stderr are appended to it.
  bool expendable = false;    ///< Whether the run goes on without it.
};

/// Starts a program in its own process group, so that Ctrl-C at the terminal does not reach it. It receives
/// SIGTERM when this process dies, for whatever reason. Call from the main thread. Throws std::runtime_error
/// naming the executable if it cannot be started.
pid_t StartProcess(const Program& program);

/// Makes this process the program, which keeps its streams and its open files; the log is not used. Returns
/// only by an exception: std::runtime_error naming the executable if it cannot be started.
[[noreturn]] void Become(const Program& program);

/// The last lines of a log; "" if it is empty or cannot be read. Reads at most the last 64 KB.
std::string LastLines(const std::filesystem::path& log, int count);

/// Describes a status of waitpid: "exit code 3", "signal 9 (Killed)".
std::string DescribeEnd(int wait_status);

}  // namespace thalweg::cli
