#include "services/explorer/adapter/planner_inbox.h"

#include <gtest/gtest.h>

#include <thread>

namespace thalweg::explorer {
namespace {

PlannerInbox::Event Nothing() {
  return [](ExplorationLoop&) {};
}

TEST(PlannerInbox, HandsOverAllEventsInOrder) {
  PlannerInbox inbox;
  std::vector<int> order;
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(inbox.TryPush([&order, k](ExplorationLoop&) { order.push_back(k); }));
  }
  ExplorationLoop loop({});
  for (const auto& event : inbox.Take({})) event(loop);
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(inbox.empty());
}

TEST(PlannerInbox, HoldsNoMoreEventsAndVoxelsThanItMay) {
  PlannerInbox inbox;
  EXPECT_TRUE(inbox.TryPush(Nothing(), 2 * PlannerInbox::kMostVoxels)) << "into an empty one";
  EXPECT_FALSE(inbox.TryPush(Nothing(), 1));
  inbox.Take({});
  EXPECT_TRUE(inbox.TryPush(Nothing(), PlannerInbox::kMostVoxels - 1));
  EXPECT_TRUE(inbox.TryPush(Nothing(), 1));
  EXPECT_FALSE(inbox.TryPush(Nothing(), 1));
  for (std::size_t k = 2; k < PlannerInbox::kMostEvents; ++k) ASSERT_TRUE(inbox.TryPush(Nothing()));
  EXPECT_FALSE(inbox.TryPush(Nothing()));
}

TEST(PlannerInbox, AStopEndsTheWait) {
  PlannerInbox inbox;
  std::jthread taker([&](const std::stop_token& stop) { EXPECT_TRUE(inbox.Take(stop).empty()); });
  taker.request_stop();
}

}  // namespace
}  // namespace thalweg::explorer
