#include "common/dds/watchdog.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <future>

#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

TEST(StallDetector, ReportsAThreadThatIsBusyWithoutProgressForTheLimit) {
  StallDetector detector(20s, 1s);
  EXPECT_FALSE(detector.Look(1, true, 1s)) << "that was progress";
  for (int k = 0; k < 19; ++k) EXPECT_FALSE(detector.Look(1, true, 1s)) << k;
  EXPECT_TRUE(detector.Look(1, true, 1s));
}

TEST(StallDetector, AThreadThatWaitsOrAdvancesMayTakeForever) {
  StallDetector detector(5s, 1s);
  for (std::uint64_t k = 0; k < 100; ++k) EXPECT_FALSE(detector.Look(7, false, 1s));
  for (std::uint64_t k = 0; k < 100; ++k) EXPECT_FALSE(detector.Look(8 + k / 4, true, 1s));
}

TEST(StallDetector, TimeInWhichTheProcessWasStoppedDoesNotCount) {
  StallDetector detector(5s, 1s);
  EXPECT_FALSE(detector.Look(1, true, 1s));
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(detector.Look(1, true, 1s));
  EXPECT_FALSE(detector.Look(1, true, 3600s));
  EXPECT_TRUE(detector.Look(1, true, 1s));
}

TEST(Watchdog, NamesWhatHangs) {
  std::promise<std::string> stalled;
  Watchdog watchdog(50ms, [&](const std::string& what) { stalled.set_value(what); });
  watchdog.Begin("depth/points");
  EXPECT_EQ(stalled.get_future().get(), "depth/points");
}

class WatchdogDeathTest : public testing::Test {};

TEST_F(WatchdogDeathTest, AHandlerThatBlocksEndsTheProcessWithItsName) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        spdlog::set_default_logger(spdlog::stderr_logger_st("hanging"));  // as in every service
        BusOptions options = test::BusOptionsForTest("hanging");
        options.watchdog = 200ms;
        Bus bus(options);
        const auto out = bus.Advertise<topics::MotionStatus>();
        bus.Subscribe<topics::MotionStatus>([](const auto&) { std::promise<void>().get_future().wait(); });
        bus.EveryWall(20ms, [&] { out.Write({}); });
        bus.Spin({});
      },
      "hangs: no progress for 0.2 s, in the handling of controller/status");
}

TEST(Watchdog, ABusThatIsIdleOrBusyWithManyThingsIsLeftAlone) {
  BusOptions options = test::BusOptionsForTest("working");
  options.watchdog = 100ms;
  Bus bus(options);
  std::stop_source stop;
  int ticks = 0;
  bus.EveryWall(150ms, [&] {  // idle for longer than the limit in between
    if (++ticks == 8) stop.request_stop();
  });
  bus.Spin(stop.get_token());
  EXPECT_EQ(ticks, 8);
}

}  // namespace
}  // namespace thalweg::dds
