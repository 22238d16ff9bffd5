#include "common/base/real_time.h"

#include <gtest/gtest.h>

#include <thread>

namespace thalweg {
namespace {

int Policy() {
  return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
}

TEST(RealTime, IsThatOfOneThreadForItsLifeWhereTheProcessMay) {
  ASSERT_EQ(Policy(), SCHED_OTHER);
  {
    const RealTime on_time;
    EXPECT_EQ(Policy(), on_time.granted() ? SCHED_FIFO : SCHED_OTHER);
    int started = -1;
    std::jthread([&] { started = Policy(); }).join();
    EXPECT_EQ(started, SCHED_OTHER);
  }
  EXPECT_EQ(Policy(), SCHED_OTHER);
}

}  // namespace
}  // namespace thalweg
