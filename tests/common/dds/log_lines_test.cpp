#include "common/dds/log_lines.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

TEST(LogLines, AreTakenOnceAndInOrder) {
  LogLines log;
  log.Add({.stamp = Time{std::chrono::seconds(1)}, .level = LogLevel::kWarning, .text = "first"});
  log.Add({.stamp = Time{std::chrono::seconds(2)}, .text = "second"});
  const std::vector<LogLine> lines = log.Take();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].text, "first");
  EXPECT_EQ(lines[0].level, LogLevel::kWarning);
  EXPECT_EQ(lines[1].text, "second");
  EXPECT_EQ(lines[1].stamp, Time{std::chrono::seconds(2)});
  EXPECT_TRUE(log.Take().empty());
}

TEST(LogLines, OfAFloodTheFirstRemainAndTheRestIsCounted) {
  LogLines log;
  for (std::size_t n = 0; n < LogLines::kMost + 7; ++n) log.Add({.stamp = Time{}, .text = std::to_string(n)});
  const std::vector<LogLine> lines = log.Take();
  ASSERT_EQ(lines.size(), LogLines::kMost + 1);
  EXPECT_EQ(lines.front().text, "0");
  EXPECT_EQ(lines[LogLines::kMost - 1].text, std::to_string(LogLines::kMost - 1));
  EXPECT_EQ(lines.back().text, "7 more lines are only in the log of the process");
  log.Add({.stamp = Time{}, .text = "after"});
  ASSERT_EQ(log.Take().size(), 1U);
}

TEST(LogLines, CutsALongLine) {
  LogLines log;
  log.Add({.stamp = Time{}, .text = std::string(LogLines::kLongest + 1, 'x')});
  EXPECT_EQ(log.Take().front().text.size(), LogLines::kLongest);
}

TEST(LogLines, TravelWithoutWhatControlsATerminal) {
  const LogLine line{.stamp = Time{std::chrono::milliseconds(1500)},
                     .level = LogLevel::kError,
                     .text = "a peer said \033[2J"};
  const rcl_interfaces::msg::Log message = ToIdl(line, "mapper");
  EXPECT_EQ(message.stamp().sec(), 1);
  EXPECT_EQ(message.stamp().nanosec(), 500'000'000U);
  EXPECT_EQ(message.level(), 40);
  EXPECT_EQ(message.name(), "mapper");
  EXPECT_EQ(message.msg().find('\033'), std::string::npos);
  EXPECT_EQ(message.msg().substr(0, 12), "a peer said ");
}

}  // namespace
}  // namespace thalweg::dds
