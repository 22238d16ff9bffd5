#include "services/recorder/core/topic_pattern.h"

#include <gtest/gtest.h>

namespace thalweg::recorder {
namespace {

TEST(TopicPattern, AStarStandsForAnything) {
  EXPECT_TRUE(Matches("odometry", "/odometry"));
  EXPECT_TRUE(Matches("/odometry", "odometry"));
  EXPECT_FALSE(Matches("odometry", "odometry/status"));
  EXPECT_TRUE(Matches("stereo/*", "stereo/left/image_raw"));
  EXPECT_TRUE(Matches("*/left/*", "stereo/left/image_raw"));
  EXPECT_TRUE(Matches("*", ""));
  EXPECT_TRUE(Matches("a*b*c", "axxbyybc"));
  EXPECT_FALSE(Matches("a*b*c", "axxcyyb"));
  EXPECT_FALSE(Matches("", "a"));
}

}  // namespace
}  // namespace thalweg::recorder
