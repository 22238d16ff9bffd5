#include "services/gateway/core/history_feed.h"

#include <gtest/gtest.h>

#include <cstring>

namespace thalweg::gateway {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

HistoryFeed::Row At(Duration time) {
  return {Time(time), 1, 2, 3, 4, 5, 6};
}

struct Part {
  bool reset;
  std::vector<double> times;
};
std::optional<Part> Read(const HistoryFeed& feed, std::uint64_t& cursor) {
  const std::optional<Feed::Message> message = feed.Next(cursor);
  if (!message) return std::nullopt;
  const std::vector<std::uint8_t>& bytes = *message->bytes;
  std::uint32_t count = 0;
  std::memcpy(&count, &bytes[8], 4);
  Part part{bytes[4] == 1, std::vector<double>(count)};
  std::memcpy(part.times.data(), &bytes[4 + 8], 8 * count);
  return part;
}

TEST(HistoryFeed, ALateClientGetsTheWholeRunAndThenItsNewRows) {
  HistoryFeed feed;
  std::uint64_t cursor = 0;
  EXPECT_FALSE(Read(feed, cursor));
  for (int n = 0; n < 5; ++n) feed.Add(At(n * 1s));
  const std::optional<Part> whole = Read(feed, cursor);
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->reset);
  EXPECT_EQ(whole->times, (std::vector<double>{0, 1, 2, 3, 4}));
  EXPECT_FALSE(Read(feed, cursor));
  feed.Add(At(5s));
  const std::optional<Part> more = Read(feed, cursor);
  ASSERT_TRUE(more);
  EXPECT_FALSE(more->reset);
  EXPECT_EQ(more->times, std::vector<double>{5});
}

TEST(HistoryFeed, RowsCloserThanTheIntervalAreLeftOut) {
  HistoryFeed feed;
  for (int n = 0; n < 100; ++n) feed.Add(At(n * 10ms));
  EXPECT_EQ(feed.row_count(), 4U);
}

TEST(HistoryFeed, ALongRunIsThinnedAndSentAgain) {
  HistoryFeed feed;
  std::uint64_t cursor = 0;
  for (std::size_t n = 0; n < 10 * HistoryFeed::kMaxRows; ++n) feed.Add(At(static_cast<int>(n) * 250ms));
  EXPECT_LE(feed.row_count(), HistoryFeed::kMaxRows);
  EXPECT_GE(feed.row_count(), HistoryFeed::kMaxRows / 2);
  cursor = 1ULL << 32 | 7;  // before the thinning
  const std::optional<Part> part = Read(feed, cursor);
  ASSERT_TRUE(part);
  EXPECT_TRUE(part->reset);
  EXPECT_EQ(part->times.size(), feed.row_count());
}

TEST(HistoryFeed, AJumpBackForgetsWhatIsLater) {
  HistoryFeed feed;
  std::uint64_t cursor = 0;
  for (int n = 0; n < 10; ++n) feed.Add(At(n * 1s));
  Read(feed, cursor);
  feed.Add(At(4500ms));
  const std::optional<Part> part = Read(feed, cursor);
  ASSERT_TRUE(part);
  EXPECT_TRUE(part->reset);
  EXPECT_EQ(part->times, (std::vector<double>{0, 1, 2, 3, 4, 4.5}));
}

TEST(HistoryFeed, WhereTimeIsMissingAfterAJumpARowWithoutAPositionInterruptsThePath) {
  const auto rows = [](bool interrupted, Duration next) {
    HistoryFeed feed;
    feed.Add(At(1s));
    if (interrupted) feed.Interrupt();
    feed.Add(At(next));
    feed.Add(At(next + 300ms));
    return feed.row_count();
  };
  EXPECT_EQ(rows(true, 9s), 4U);
  EXPECT_EQ(rows(false, 9s), 3U) << "a fast run";
  EXPECT_EQ(rows(true, 1500ms), 3U) << "nothing is missing";
}

TEST(HistoryFeed, ARestartedClockBeginsANewHistory) {
  HistoryFeed feed;
  std::uint64_t cursor = 0;
  feed.Add(At(100s));
  Read(feed, cursor);
  feed.Add(At(1s));
  const std::optional<Part> part = Read(feed, cursor);
  ASSERT_TRUE(part);
  EXPECT_TRUE(part->reset);
  EXPECT_EQ(part->times, std::vector<double>{1});
}

}  // namespace
}  // namespace thalweg::gateway
