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
  std::filesystem::path log;  ///< Takes stdout and stderr; appended to.
};

/// Starts it in its own process group, so that a Ctrl-C at the terminal does not reach it; it is asked to end
/// (SIGTERM) when this process dies, however that happens. To be called from the main thread.
/// Throws std::runtime_error naming the executable when it cannot be started.
pid_t StartProcess(const Program& program);

/// The last lines of a log, "" when it is empty or cannot be read. Reads the last 64 KB at most.
std::string LastLines(const std::filesystem::path& log, int count);

/// "exit code 3", "signal 9 (Killed)", out of waitpid's status.
std::string DescribeEnd(int wait_status);

}  // namespace thalweg::cli
