#include "common/service/healthy.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/test_bus.h"

namespace thalweg {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

TEST(Healthy, AServiceWhoseLoopAdvancesIsHealthy) {
  dds::BusOptions options = test::BusOptionsForTest("mapper");
  options.publish_health = true;
  dds::Bus bus(options);
  const std::jthread spinning([&bus](const std::stop_token& stop) { bus.Spin(stop); });
  const Healthiness found = CheckHealthy(options, test::kPatience);
  EXPECT_TRUE(found.healthy) << found.text;
  EXPECT_NE(found.text.find("process " + std::to_string(getpid()) + " works"), std::string::npos)
      << found.text;
}

TEST(Healthy, AServiceThatDoesNotRunIsNotHealthy) {
  const Healthiness found = CheckHealthy(test::BusOptionsForTest("mapper"), 300ms);
  EXPECT_FALSE(found.healthy);
  EXPECT_NE(found.text.find("it does not run, or hangs"), std::string::npos) << found.text;
}

TEST(Healthy, AnotherServiceAndAnotherMachineDoNotMakeItHealthy) {
  dds::BusOptions options = test::BusOptionsForTest("mapper");
  dds::Bus bus(options);
  const auto out = bus.Advertise<dds::topics::Health>();
  double uptime_s = 0.0;
  bus.EveryWall(20ms, [&] {
    thalweg_msgs::msg::ServiceHealth health = bus.health().ToMessage(Time{});
    health.uptime_s(uptime_s += 0.02);
    health.service("explorer");
    out.Write(health);
    health.service("mapper");
    health.host("another machine");
    out.Write(health);
  });
  const std::jthread spinning([&bus](const std::stop_token& stop) { bus.Spin(stop); });
  EXPECT_FALSE(CheckHealthy(options, 3s).healthy);
}

TEST(Healthy, AServiceThatIsHeardOnceAndThenHangsIsNotHealthy) {
  dds::BusOptions options = test::BusOptionsForTest("mapper");
  dds::Bus bus(options);
  const auto out = bus.Advertise<dds::topics::Health>();
  const thalweg_msgs::msg::ServiceHealth health = bus.health().ToMessage(Time{});
  bus.EveryWall(50ms, [&] { out.Write(health); });  // the same message, again and again
  const std::jthread spinning([&bus](const std::stop_token& stop) { bus.Spin(stop); });
  const Healthiness found = CheckHealthy(options, 3s);
  EXPECT_FALSE(found.healthy);
  EXPECT_NE(found.text.find("its loop does not advance"), std::string::npos) << found.text;
}

}  // namespace
}  // namespace thalweg
