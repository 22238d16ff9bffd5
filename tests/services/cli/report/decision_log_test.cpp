#include "services/cli/report/decision_log.h"

#include <gtest/gtest.h>

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

const Time kStart = Time{} + 100s;

DecisionLog::Status Made(Time stamp, std::uint64_t plans, std::uint64_t abandoned = 0) {
  DecisionLog::Status status;
  status.stamp = stamp;
  status.time = Seconds(stamp - kStart);
  status.plans = plans;
  status.abandoned = abandoned;
  status.activity = "plan " + std::to_string(plans);
  status.last_interruption = abandoned > 0 ? "path blocked" : "";
  return status;
}

TEST(DecisionLog, ListsEachPlanOnceHoweverOftenItsStatusIsRepeated) {
  DecisionLog log;
  log.OnStatus(Made(kStart, 0));
  EXPECT_TRUE(log.decisions().empty()) << "no plan has been made yet";
  for (int n = 0; n < 3; ++n) log.OnStatus(Made(kStart + 1s + n * 500ms, 1));
  log.OnStatus(Made(kStart + 4s, 2));
  ASSERT_EQ(log.decisions().size(), 2U);
  EXPECT_EQ(log.decisions()[0].purpose, "plan 1");
  EXPECT_DOUBLE_EQ(log.decisions()[0].time, 1.0);
  EXPECT_EQ(log.decisions()[1].number, 2U);
}

TEST(DecisionLog, APathBelongsToItsPlanWhicheverOfThemArrivesFirst) {
  DecisionLog log;
  log.OnPath(kStart + 900ms, 1.5);  // before its status
  log.OnStatus(Made(kStart + 1s, 1));
  log.OnStatus(Made(kStart + 4s, 2));
  log.OnPath(kStart + 900ms, 1.5);  // repeated: still the first plan's
  EXPECT_FALSE(log.decisions()[1].length);
  log.OnPath(kStart + 3900ms, 2.5);  // after its status
  log.OnPath(kStart + 6s, 9.0);      // of a plan whose status is still to come
  ASSERT_EQ(log.decisions().size(), 2U);
  EXPECT_EQ(log.decisions()[0].length, 1.5);
  EXPECT_EQ(log.decisions()[1].length, 2.5);
}

TEST(DecisionLog, AnInterruptionIsThatOfThePlanThatWasUnderWay) {
  DecisionLog log;
  log.OnStatus(Made(kStart + 1s, 1));
  log.OnStatus(Made(kStart + 2s, 1, 1));
  log.OnStatus(Made(kStart + 3s, 2, 1));
  EXPECT_EQ(log.decisions()[0].interruption, "path blocked");
  EXPECT_EQ(log.decisions()[1].interruption, "");
  log.OnStatus(Made(kStart + 4s, 3, 2));  // one status for both
  EXPECT_EQ(log.decisions()[1].interruption, "path blocked");
  EXPECT_EQ(log.decisions()[2].interruption, "");
}

TEST(DecisionLog, GoesOnCountingAfterTheExplorerWasRestarted) {
  DecisionLog log;
  log.OnStatus(Made(kStart + 1s, 1, 1));
  log.OnStatus(Made(kStart + 2s, 2, 1));
  log.OnStatus(Made(kStart + 3s, 0));
  log.OnStatus(Made(kStart + 4s, 1));
  ASSERT_EQ(log.decisions().size(), 3U);
  EXPECT_EQ(log.decisions()[2].number, 3U);
  EXPECT_EQ(log.decisions()[2].interruption, "");
}

TEST(DecisionLog, ForgetsTheEarliestBeyondItsLimit) {
  DecisionLog log;
  for (std::size_t n = 1; n <= DecisionLog::kMost + 5; ++n) {
    log.OnStatus(Made(kStart + n * 1s, n));
  }
  EXPECT_EQ(log.decisions().size(), DecisionLog::kMost);
  EXPECT_EQ(log.forgotten(), 5U);
  EXPECT_EQ(log.decisions().front().number, 6U);
}

}  // namespace
}  // namespace thalweg::cli
