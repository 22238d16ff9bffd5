#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "tests/support/places.h"

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = SourceFolder();

TEST(Tree, ATestLiesInTheFolderOfWhatItTests) {
  int tests = 0;
  for (const char* const part : {"common", "services"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests" / part)) {
      const std::string name = entry.path().filename().string();
      EXPECT_FALSE(name.ends_with("_bench.cpp")) << entry.path() << " belongs to tests/benchmark";
      if (!name.ends_with("_test.cpp")) continue;
      ++tests;
      const fs::path tested = fs::relative(entry.path().parent_path(), kRoot / "tests");
      EXPECT_TRUE(fs::is_directory(kRoot / tested)) << entry.path() << ": there is no " << tested;
    }
  }
  EXPECT_GT(tests, 50);
}

TEST(Tree, TheTopHoldsWhatANewcomerLooksForAndNoMore) {
  const std::set<std::string> known = {"idl",
                                       "services",
                                       "common",
                                       "deploy",
                                       "tests",
                                       "docs",
                                       "CMakeLists.txt",
                                       "CMakePresets.json",
                                       "docker-compose.yml",
                                       "README.md",
                                       "CHANGELOG.md",
                                       "LICENSE",
                                       "CONTRIBUTING.md"};
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename().string();
    // As in .gitignore: files of builds and runs.
    if (name.starts_with(".") || name.starts_with("build") || name == "runs") continue;
    if (name == "compile_commands.json") continue;
    EXPECT_TRUE(known.contains(name)) << name;
  }
}

}  // namespace
}  // namespace thalweg::test
