#include "services/recorder/core/message_queue.h"

#include <gtest/gtest.h>

namespace thalweg::recorder {
namespace {

using std::chrono_literals::operator""s;

TEST(MessageQueue, DropsWhatDoesNotFitAndKeepsTheOrder) {
  MessageQueue queue(10);
  EXPECT_TRUE(queue.TryPush({.sequence = 1, .payload = std::vector<std::uint8_t>(20)}));  // fits when empty
  EXPECT_FALSE(queue.TryPush({.sequence = 2, .payload = std::vector<std::uint8_t>(1)}));
  EXPECT_EQ(queue.Pop(0s)->sequence, 1U);
  EXPECT_TRUE(queue.TryPush({.sequence = 3, .payload = std::vector<std::uint8_t>(5)}));
  EXPECT_TRUE(queue.TryPush({.sequence = 4, .payload = std::vector<std::uint8_t>(5)}));
  EXPECT_FALSE(queue.TryPush({.sequence = 5, .payload = std::vector<std::uint8_t>(1)}));
  queue.Close();
  EXPECT_FALSE(queue.TryPush({.sequence = 6, .payload = {}}));
  EXPECT_FALSE(queue.exhausted());
  EXPECT_EQ(queue.Pop(0s)->sequence, 3U);
  EXPECT_EQ(queue.Pop(0s)->sequence, 4U);
  EXPECT_FALSE(queue.Pop(10s).has_value());  // closed: does not wait
  EXPECT_TRUE(queue.exhausted());
}

}  // namespace
}  // namespace thalweg::recorder
