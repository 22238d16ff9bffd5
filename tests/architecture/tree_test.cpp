#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "tests/architecture/sources.h"

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;

TEST(Tree, ATestLiesInTheFolderOfWhatItTests) {
  int tests = 0;
  for (const char* const part : {"common", "services"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests" / part)) {
      const std::string name = entry.path().filename().string();
      EXPECT_FALSE(name.ends_with("_bench.cpp")) << entry.path() << " belongs to tests/benchmark";
      if (!name.ends_with(".cpp") && !name.ends_with(".h")) continue;
      if (name.ends_with("_test.cpp")) ++tests;
      const fs::path tested = fs::relative(entry.path().parent_path(), kRoot / "tests");
      if (tested.filename() == "support") continue;  // shared by the tests of one service
      EXPECT_TRUE(fs::is_directory(kRoot / tested)) << entry.path() << ": there is no " << tested;
      const bool of_a_service = tested.parent_path() == "services";
      EXPECT_FALSE(of_a_service) << entry.path() << " belongs to core, adapter or another of its folders";
    }
  }
  EXPECT_GT(tests, 50);
}

TEST(Tree, ATestIsNamedAfterTheSourceThatItTests) {
  for (const char* const part : {"common", "services"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests" / part)) {
      const fs::path test = fs::relative(entry.path(), kRoot / "tests");
      if (!test.string().ends_with("_test.cpp")) continue;
      std::string name = test.stem().string();
      name.resize(name.size() - std::string("_test").size());
      bool found = false;
      for (const auto& source : fs::directory_iterator(kRoot / test.parent_path())) {
        // ray for ray.cpp, bus_network for an aspect of bus.cpp
        const std::string stem = source.path().stem().string();
        found |= name == stem || name.starts_with(stem + "_");
      }
      EXPECT_TRUE(found) << test << ": no source of that name in " << test.parent_path();
    }
  }
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
