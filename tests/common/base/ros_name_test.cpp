#include "common/base/ros_name.h"

#include <gtest/gtest.h>

#include <random>
#include <regex>
#include <string>

namespace thalweg {
namespace {

TEST(RosName, IsWordsSeparatedBySingleSlashes) {
  for (const char* const good : {"a", "odometry", "stereo/left/image_raw", "_a/b_2", "A/B3"})
    EXPECT_TRUE(IsRosName(good)) << good;
  for (const char* const bad : {"", "/a", "a/", "a//b", "2a", "a/2", "a b", "a-b", "a__b", "a\n", "\xc3\xa4"})
    EXPECT_FALSE(IsRosName(bad)) << bad;
}

TEST(RosName, IsWhatARegularExpressionSays) {
  const std::regex words("[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*");
  const std::string letters = "aZ_0/-";
  std::mt19937 random(1);
  for (int n = 0; n < 20'000; ++n) {
    std::string text(random() % 7U, ' ');
    for (char& c : text) c = letters[random() % letters.size()];
    EXPECT_EQ(IsRosName(text), std::regex_match(text, words) && text.find("__") == std::string::npos) << text;
  }
}

}  // namespace
}  // namespace thalweg
