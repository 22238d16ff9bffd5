#include "services/inspector/core/delay.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/at_second.h"

namespace thalweg::inspector {
namespace {

using test::AtSecond;
using testing::HasSubstr;
using testing::Not;

constexpr double kToday = 1.7e9;  // [s] By a machine's clock.

std::string Nobody() {
  return {};
}

TEST(StampDelay, AStampIsReadFromItsSecondsAndNanoseconds) {
  const Value stamp{std::vector<Value>{{Number(std::int64_t{12})}, {Number(std::uint64_t{500'000'000})}}};
  EXPECT_EQ(StampIn(stamp), AtSecond(12.5));
}

TEST(StampDelay, IsAgainstThisMachinesClockWhereThereIsNoOther) {
  StampDelay delay(10, false);
  EXPECT_FALSE(delay.Report());
  delay.Add(AtSecond(kToday), AtSecond(kToday + 0.25), Nobody);
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 0.250\n"));
  EXPECT_EQ(delay.ClockText(), "against this machine's clock");
}

TEST(StampDelay, IsAgainstTheRunsClockOnceThatIsHeard) {
  StampDelay delay(10, false);
  delay.Add(AtSecond(7.0), AtSecond(kToday), Nobody);  // in simulated time, before the clock was heard
  EXPECT_FALSE(delay.Report());
  delay.SetRunTime(AtSecond(8.5));
  delay.Add(AtSecond(8.0), AtSecond(kToday), Nobody);
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 0.500\n"));
  EXPECT_EQ(delay.ClockText(), "against the run's clock");
}

TEST(StampDelay, IsAgainstThisMachinesClockWhereThatIsAskedFor) {
  StampDelay delay(10, true);
  delay.SetRunTime(AtSecond(8.5));
  delay.Add(AtSecond(kToday - 1.0), AtSecond(kToday), Nobody);
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 1.000\n"));
  EXPECT_EQ(delay.ClockText(), "against this machine's clock");
}

TEST(StampDelay, SaysThatSimulatedTimeHasNoClockToBeComparedWith) {
  StampDelay delay(10, false);
  delay.Add(AtSecond(7.0), AtSecond(kToday), Nobody);
  EXPECT_FALSE(delay.Report());
  EXPECT_THAT(delay.ClockText(), HasSubstr("no run's clock has been heard"));
}

TEST(StampDelay, SaysThatStampsAheadOfTheClockWereMadeByAnotherIfMostAre) {
  StampDelay delay(10, false);
  delay.Add(AtSecond(kToday + 0.9), AtSecond(kToday), Nobody);
  EXPECT_THAT(delay.ClockText(), Not(HasSubstr("another clock")));
  delay.Add(AtSecond(kToday + 1.1), AtSecond(kToday), Nobody);
  delay.Add(AtSecond(kToday + 1.1), AtSecond(kToday), Nobody);
  EXPECT_THAT(delay.ClockText(), HasSubstr("another clock made them"));
  StampDelay of_run(10, false);
  of_run.SetRunTime(AtSecond(8.0));
  of_run.Add(AtSecond(7.9), AtSecond(kToday), Nobody);
  of_run.Add(AtSecond(9.5), AtSecond(kToday), Nobody);  // before a sample of the clock that came late
  of_run.SetRunTime(AtSecond(9.5));
  of_run.Add(AtSecond(9.5), AtSecond(kToday), Nobody);
  EXPECT_EQ(of_run.ClockText(), "against the run's clock");
}

TEST(StampDelay, NamesWhoseStampsAreFarFromTheClockAndLeavesThemOut) {
  StampDelay delay(10, false);
  delay.SetRunTime(AtSecond(100.0));
  delay.Add(AtSecond(99.5), AtSecond(kToday), [] { return "mapper"; });
  EXPECT_EQ(delay.ClockText(), "against the run's clock");
  delay.Add(AtSecond(kToday), AtSecond(kToday), [] { return "simulator"; });
  delay.Add(AtSecond(kToday), AtSecond(kToday), [] { return "simulator"; });
  EXPECT_EQ(delay.ClockText(),
            "against the run's clock; more than an hour from it, so by another clock, are the stamps of "
            "simulator, which are left out");
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 0.500\n"));
}

TEST(StampDelay, LeavesNoneOutIfThisMachinesClockIsAskedFor) {
  StampDelay delay(10, true);
  delay.Add(AtSecond(kToday - 7200.0), AtSecond(kToday), Nobody);
  EXPECT_THAT(*delay.Report(), HasSubstr("average delay: 7200.000\n"));
  EXPECT_EQ(delay.ClockText(),
            "against this machine's clock; more than an hour from it, so by another clock, are the stamps of "
            "some senders");
}

TEST(DelayReport, SaysOnceByWhichClockAndThenOnlyTheFigures) {
  StampDelay delay(10, false);
  DelayReport report(delay);
  EXPECT_EQ(report.Text({}), "against this machine's clock");
  EXPECT_EQ(report.Text({}), std::nullopt) << "there is nothing new";
  delay.Add(AtSecond(kToday), AtSecond(kToday + 0.25), Nobody);
  EXPECT_EQ(report.Text({}), delay.Report());
  delay.SetRunTime(AtSecond(kToday));
  EXPECT_EQ(report.Text({}), "against the run's clock\n" + *delay.Report());
}

TEST(DelayReport, SaysThatOtherMachinesHaveOtherClocksUnlessTheRunHasOne) {
  StampDelay delay(10, false);
  delay.SetRunTime(AtSecond(8.0));
  EXPECT_EQ(DelayReport(delay).Text({"arm", "base"}), "against the run's clock");
  const StampDelay by_machine(10, true);
  DelayReport report(by_machine);
  EXPECT_EQ(report.Text({"arm", "base"}),
            "against this machine's clock\n"
            "published on arm, base: a delay contains the difference between the machines' clocks");
  EXPECT_EQ(report.Text({"arm", "base"}), std::nullopt);
}

}  // namespace
}  // namespace thalweg::inspector
