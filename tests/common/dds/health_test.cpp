#include "common/dds/health.h"

#include <gtest/gtest.h>

#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

TEST(Health, CountsByTopicAndRemembersTheLatestReason) {
  Health health("mapper");
  health.Reject<topics::DepthPoints>("no points");
  health.Reject<topics::DepthPoints>("frame_id is \"lidar\"");
  health.Reject<topics::Odometry>("position is nan");
  health.Drop<topics::DepthPoints>("no pose yet");
  EXPECT_EQ(health.rejected(), 3U);
  EXPECT_EQ(health.dropped(), 1U);

  const thalweg_msgs::msg::ServiceHealth message = health.ToMessage(Time{std::chrono::seconds(5)});
  EXPECT_EQ(message.service(), "mapper");
  EXPECT_EQ(message.header().stamp().sec(), 5);
  ASSERT_EQ(message.rejected().size(), 2U);
  EXPECT_EQ(message.rejected()[0].name(), "depth/points");
  EXPECT_EQ(message.rejected()[0].count(), 2U);
  EXPECT_EQ(message.rejected()[0].last(), "frame_id is \"lidar\"");
  ASSERT_EQ(message.dropped().size(), 1U);
  EXPECT_EQ(message.dropped()[0].last(), "no pose yet");
}

TEST(Health, ReasonsThatQuoteAPeerAreCleaned) {
  Health health("mapper");
  health.Reject<topics::DepthPoints>("frame_id is \"\x1B[2J" + std::string(100'000, 'x') + "\"");
  const std::string last = health.ToMessage(Time{}).rejected()[0].last();
  EXPECT_EQ(last.substr(0, 17), "frame_id is \"\uFFFD[");
  EXPECT_LT(last.size(), 300U);
}

TEST(Health, CountsFilesThatCouldNotBeWritten) {
  Health health("mapper");
  health.FileNotWritten("a.map: cannot be written: No space left on device");
  health.FileNotWritten("b.map: cannot be written: No space left on device");
  const auto message = health.ToMessage(Time{});
  ASSERT_EQ(message.dropped().size(), 1U);
  EXPECT_EQ(message.dropped()[0].name(), Health::kFiles);
  EXPECT_EQ(message.dropped()[0].count(), 2U);
  EXPECT_EQ(message.dropped()[0].last(), "b.map: cannot be written: No space left on device");
  EXPECT_EQ(health.rejected(), 0U);
}

TEST(Health, ARemarkReplacesTheReasonAndCountsNothing) {
  Health health("mapper");
  health.FileNotWritten("a.map: cannot be written: No space left on device");
  health.Drop(Health::kFiles, "a.map can be written again", 0);
  const auto message = health.ToMessage(Time{});
  ASSERT_EQ(message.dropped().size(), 1U);
  EXPECT_EQ(message.dropped()[0].count(), 1U);
  EXPECT_EQ(message.dropped()[0].last(), "a.map can be written again");
}

TEST(Health, ReportsHowLongWorkTook) {
  Health health("mapper");
  for (int k = 1; k <= 100; ++k) health.Timed("integration", k);
  const auto message = health.ToMessage(Time{});
  ASSERT_EQ(message.timings().size(), 1U);
  EXPECT_EQ(message.timings()[0].name(), "integration");
  EXPECT_EQ(message.timings()[0].count(), 100U);
  EXPECT_NEAR(message.timings()[0].p95_ms(), 95.0, 0.95);
}

}  // namespace
}  // namespace thalweg::dds
