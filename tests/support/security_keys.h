#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::test {

inline bool HasOpenssl() {
  return OutcomeOf("command -v openssl").exit_code == 0;
}

/// A folder of keys that deploy/make-keys made, removed at the end.
class KeyFolder {
 public:
  /// @param name  Unique within the test.
  /// @param options  Options of deploy/make-keys, e.g. "--role mapper --days 10".
  explicit KeyFolder(const std::string& name, const std::string& options = "")
      : path_(std::filesystem::path(testing::TempDir()) /
              (testing::UnitTest::GetInstance()->current_test_info()->name() + ("-" + name) + "-" +
               std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    const Outcome outcome =
        OutcomeOf(SourceFolder() + "/deploy/make-keys '" + path_.string() + "' " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  ~KeyFolder() { std::filesystem::remove_all(path_); }
  KeyFolder(const KeyFolder&) = delete;
  KeyFolder& operator=(const KeyFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace thalweg::test
