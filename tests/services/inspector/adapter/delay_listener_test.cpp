#include "services/inspector/adapter/delay_listener.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <stdexcept>
#include <utility>

#include "common/dds/convert.h"
#include "tests/support/at_second.h"
#include "tests/support/test_bus.h"

namespace thalweg::inspector {
namespace {

using std::chrono_literals::operator""ms;
using test::AtSecond;

class DelayListenerTest : public testing::Test {
 protected:
  static dds::BusOptions ListenerOptions() {
    dds::BusOptions options = test::BusOptionsForTest("listener");
    options.surveys = true;
    return options;
  }
  template <class Topic>
  static OpenTopic Open() {
    return *FindOpenTopic(dds::InfoOf<Topic>().name, "", {});
  }

  /// Again and again, with the run's clock at 8.5 s.
  void SendOdometry(Time stamp) {
    rosgraph_msgs::msg::Clock now;
    now.clock() = dds::ToIdl(AtSecond(8.5));
    nav_msgs::msg::Odometry message;
    message.header().stamp() = dds::ToIdl(stamp);
    to_.EveryWall(20ms, [now, message, clock = from_.Advertise<dds::topics::Clock>(),
                         odometry = from_.Advertise<dds::topics::Odometry>()] {
      clock.Write(now);
      odometry.Write(message);
    });
  }

  dds::Bus from_{test::BusOptionsForTest("robot")};
  dds::Bus to_{ListenerOptions()};
};

TEST_F(DelayListenerTest, ARunThatHasAClockIsMeasuredAgainstIt) {
  DelayListener listener(to_, Open<dds::topics::Odometry>(), 10, false);
  EXPECT_EQ(listener.received(), 0U);
  SendOdometry(AtSecond(8.0));
  // The first messages may come before the clock; their stamps are too old to be compared with another one.
  std::string printed;
  const bool has_figures = to_.SpinUntil(
      [&] {
        if (const auto text = listener.Report()) printed = *text;
        return printed.find("average delay: ") != std::string::npos;
      },
      test::kPatience);
  ASSERT_TRUE(has_figures);
  EXPECT_GT(listener.received(), 0U);
  EXPECT_THAT(printed, testing::HasSubstr("average delay: 0.500\n"));
}

TEST_F(DelayListenerTest, AServiceThatStampsByAnotherClockThanTheRunsIsNamed) {
  const auto clock = from_.Advertise<dds::topics::Clock>();
  const auto health = from_.Advertise<dds::topics::Health>();
  DelayListener listener(to_, Open<dds::topics::Health>(), 10, false);
  rosgraph_msgs::msg::Clock now;
  now.clock() = dds::ToIdl(AtSecond(8.5));
  to_.EveryWall(20ms, [&] {
    clock.Write(now);
    for (const auto& [service, stamp] : {std::pair("mapper", 8.0), std::pair("simulator", 1.7e9)}) {
      thalweg_msgs::msg::ServiceHealth message;
      message.service(service);
      message.header().stamp() = dds::ToIdl(AtSecond(stamp));
      health.Write(message);
    }
  });
  std::string printed;
  const bool is_named = to_.SpinUntil(
      [&] {
        if (const auto text = listener.Report()) printed += *text + '\n';
        return printed.find("average delay: 0.500\n") != std::string::npos &&
               printed.find("are the stamps of simulator, which are left out") != std::string::npos;
      },
      test::kPatience);
  EXPECT_TRUE(is_named) << printed;
}

TEST_F(DelayListenerTest, ASenderWithoutANameInItsMessagesIsThePublisher) {
  DelayListener listener(to_, Open<dds::topics::Odometry>(), 10, false);
  SendOdometry(AtSecond(1.7e9));
  std::string printed;
  const bool is_named = to_.SpinUntil(
      [&] {
        if (const auto text = listener.Report()) printed += *text + '\n';
        return printed.find("the stamps of \"robot\" (" + std::to_string(getpid()) + ")") !=
               std::string::npos;
      },
      test::kPatience);
  EXPECT_TRUE(is_named) << printed;
}

TEST_F(DelayListenerTest, WithoutAHeaderADelayIsNotKnown) {
  try {
    const DelayListener listener(to_, Open<dds::topics::Transforms>(), 10, false);
    FAIL() << "tf has no header of its own";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(),
              std::string(dds::topics::Transforms::kName) + " has no header, so its delay is not known");
  }
}

}  // namespace
}  // namespace thalweg::inspector
