#include "services/inspector/core/delay.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kToday = 1.7e9;  // [s] By a machine's clock.

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

TEST(StampDelay, AStampIsReadFromItsSecondsAndNanoseconds) {
  const Value stamp{std::vector<Value>{{Number(std::int64_t{12})}, {Number(std::uint64_t{500'000'000})}}};
  EXPECT_EQ(StampIn(stamp), At(12.5));
}

TEST(StampDelay, IsAgainstThisMachinesClockWhereThereIsNoOther) {
  StampDelay delay(10, false);
  EXPECT_FALSE(delay.Report());
  delay.Add(At(kToday), At(kToday + 0.25));
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 0.250\n"));
  EXPECT_EQ(delay.ClockText(), "against this machine's clock");
}

TEST(StampDelay, IsAgainstTheRunsClockOnceThatIsHeard) {
  StampDelay delay(10, false);
  delay.Add(At(7.0), At(kToday));  // in simulated time, before the clock was heard
  EXPECT_FALSE(delay.Report());
  delay.SetRunTime(At(8.5));
  delay.Add(At(8.0), At(kToday));
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 0.500\n"));
  EXPECT_EQ(delay.ClockText(), "against the run's clock");
}

TEST(StampDelay, IsAgainstThisMachinesClockWhereThatIsAskedFor) {
  StampDelay delay(10, true);
  delay.SetRunTime(At(8.5));
  delay.Add(At(kToday - 1.0), At(kToday));
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 1.000\n"));
  EXPECT_EQ(delay.ClockText(), "against this machine's clock");
}

TEST(StampDelay, SaysThatSimulatedTimeHasNoClockToBeComparedWith) {
  StampDelay delay(10, false);
  delay.Add(At(7.0), At(kToday));
  EXPECT_FALSE(delay.Report());
  EXPECT_THAT(delay.ClockText(), HasSubstr("no run's clock has been heard"));
}

TEST(StampDelay, SaysThatStampsAheadOfTheClockWereMadeByAnother) {
  StampDelay delay(10, false);
  delay.Add(At(kToday + 0.004), At(kToday));  // as far as synchronized machines are apart
  EXPECT_THAT(delay.ClockText(), Not(HasSubstr("another clock")));
  delay.Add(At(kToday + 0.006), At(kToday));
  EXPECT_THAT(delay.ClockText(), HasSubstr("another clock made them"));
  StampDelay of_run(10, false);
  of_run.SetRunTime(At(8.0));
  of_run.Add(At(8.05), At(kToday));  // the clock's next step is under way
  EXPECT_THAT(of_run.ClockText(), Not(HasSubstr("another clock")));
}

}  // namespace
}  // namespace thalweg::inspector
