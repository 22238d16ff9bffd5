#include "services/cli/process/child_process.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace thalweg::cli {
namespace {

Program ProgramAt(const std::string& executable, const std::vector<std::string>& arguments) {
  Program program;
  program.executable = executable;
  program.arguments = arguments;
  return program;
}

TEST(ChildProcess, AProcessThatBecomesAProgramEndsAsThatDoes) {
  EXPECT_EXIT(Become(ProgramAt("/bin/true", {})), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(Become(ProgramAt("/bin/sh", {"-c", "echo \"$1\" >&2; exit 7", "sh", "a b"})),
              testing::ExitedWithCode(7), "a b");
}

TEST(ChildProcess, AProgramThatDoesNotExistIsNamed) {
  try {
    Become(ProgramAt("/nowhere/thalweg-gateway", {"--domain", "7"}));
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "cannot start /nowhere/thalweg-gateway: No such file or directory");
  }
}

}  // namespace
}  // namespace thalweg::cli
