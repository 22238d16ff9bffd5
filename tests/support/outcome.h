#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace thalweg::test {

struct Outcome {
  int exit_code = -1;
  std::string text;  ///< stdout and stderr
};

/// Runs a shell command without input.
inline Outcome OutcomeOf(const std::string& command) {
  Outcome outcome;
  FILE* const pipe = popen((command + " 2>&1 < /dev/null").c_str(), "r");
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) outcome.text += part.data();
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

}  // namespace thalweg::test
