#include "services/inspector/adapter/topic_listener.h"

#include <gmock/gmock.h>

#include "services/inspector/core/cdr.h"
#include "services/inspector/core/meters.h"
#include "services/inspector/core/yaml.h"
#include "tests/support/test_bus.h"

namespace thalweg::inspector {
namespace {

using std::chrono_literals::operator""ms;

class TopicListenerTest : public testing::Test {
 protected:
  OpenTopic Open(const std::string& name, const std::string& type = "") {
    auto topic = FindOpenTopic(name, type, {});
    EXPECT_TRUE(topic) << topic.error();
    return *topic;
  }
  /// Spins until writer and reader of odometry are matched in both directions, so that nothing is lost from
  /// then on.
  void AwaitMatch(const dds::Bus::BytesPublisher& publisher) {
    ASSERT_TRUE(from_.SpinUntil([&] { return publisher.readers() > 0; }, test::kPatience));
    ASSERT_TRUE(to_.SpinUntil([&] { return to_.Writers<dds::topics::Odometry>() > 0; }, test::kPatience));
  }

  dds::Bus from_{test::BusOptionsForTest("publisher")};
  dds::Bus to_{test::BusOptionsForTest("listener")};
};

TEST_F(TopicListenerTest, AMessageOfATypeThatItWasNotCompiledForIsDecoded) {
  const OpenTopic topic = Open("my_robot/twist", "geometry_msgs/Twist");
  std::string printed;
  TopicListener listener(to_, topic, [&](const Value& message, const dds::RawSample&) {
    printed = ToYaml(topic.schema, topic.schema.root(), message);
  });
  const auto publisher = from_.AdvertiseBytes(topic.info);
  const auto message = ParseYaml(topic.schema, "{linear: {x: 0.5}}", {});
  ASSERT_TRUE(message) << message.error();
  to_.EveryWall(20ms, [&] { publisher.Write(EncodeCdr(topic.schema, *message)); });
  ASSERT_TRUE(to_.SpinUntil([&] { return listener.received() > 0; }, test::kPatience));
  EXPECT_EQ(printed.substr(0, 18), "linear:\n  x: 0.5\n ");
  EXPECT_EQ(listener.malformed(), 0U);
}

TEST_F(TopicListenerTest, MalformedMessagesAreCountedAndNamedWithTopicAndField) {
  const std::string odometry = dds::InfoOf<dds::topics::Odometry>().name;
  int handled = 0;
  TopicListener listener(to_, Open(odometry), [&](const Value&, const dds::RawSample&) { ++handled; });
  const auto publisher = from_.AdvertiseBytes(Open(odometry).info);
  AwaitMatch(publisher);
  publisher.Write(std::vector<std::uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0xFF, 0, 0, 0});
  ASSERT_TRUE(to_.SpinUntil([&] { return listener.received() == 1; }, test::kPatience));
  EXPECT_EQ(handled, 0);
  EXPECT_EQ(listener.malformed(), 1U);
  EXPECT_EQ(listener.last_error(),
            odometry + ": header.frame_id: its length of 255 bytes is more than the 0 that are left");
}

TEST_F(TopicListenerTest, TheMeasuredRateIsThePublishersWithinOnePercent) {
  constexpr int kMessages = 300;
  const std::string odometry = dds::InfoOf<dds::topics::Odometry>().name;
  RateMeter meter(10'000);
  TopicListener listener(to_, Open(odometry), [&](const Value&, const dds::RawSample& sample) {
    meter.Add(sample.reception_stamp);
  });
  const OpenTopic topic = Open(odometry);
  const auto publisher = from_.AdvertiseBytes(topic.info);
  AwaitMatch(publisher);
  const auto bytes = EncodeCdr(topic.schema, ZeroOf(topic.schema, topic.schema.root()));
  std::vector<std::chrono::steady_clock::time_point> written;
  to_.EveryWall(10ms, [&] {
    if (written.size() == kMessages) return;
    written.push_back(std::chrono::steady_clock::now());
    publisher.Write(bytes);
  });
  ASSERT_TRUE(to_.SpinUntil([&] { return listener.received() == kMessages; }, test::kPatience));
  const double hz = (kMessages - 1) / Seconds(written.back() - written.front());
  EXPECT_NEAR(meter.hz(), hz, 0.01 * hz);
}

}  // namespace
}  // namespace thalweg::inspector
