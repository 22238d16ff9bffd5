#include "common/dds/clock_problem.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

TEST(ClockProblem, NamesStampsByAnotherClock) {
  using std::chrono_literals::operator""s;
  const Time now{1'795'507'579s};
  EXPECT_FALSE(ClockProblem(now, now));
  EXPECT_FALSE(ClockProblem(now - 5s, now));
  EXPECT_FALSE(ClockProblem(Time{}, Time{} + 4s)) << "a simulation that has just begun";
  EXPECT_EQ(ClockProblem(Time{} + 300s, now),
            "its stamp is 57 years behind the clock of all services: does it come from another clock?");
  EXPECT_EQ(ClockProblem(now + 60s, now),
            "its stamp is 60 s ahead of the clock of all services: does it come from another clock?");
  EXPECT_EQ(ClockProblem(Time{}, now), "its stamp is 0: set header.stamp by the clock of all services");
}

TEST(MissingStamp, IsNamedOnceTheClockHasRunForAWhile) {
  using std::chrono_literals::operator""s;
  EXPECT_EQ(MissingStamp(Time{}, Time{} + 6s),
            "its stamp is 0: set header.stamp by the clock of all services");
  EXPECT_FALSE(MissingStamp(Time{}, Time{} + 4s));
  EXPECT_FALSE(MissingStamp(Time{} + 1s, Time{} + 1000s)) << "late, as a cloud that has waited for a link";
}

}  // namespace
}  // namespace thalweg::dds
