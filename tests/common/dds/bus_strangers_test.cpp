#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/bus.h"
#include "tests/support/datagram_sender.h"
#include "tests/support/test_bus.h"

// What participants and datagrams that do not belong to the system can do to a bus.

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
using test::AwaitMatch;
using test::BusOptionsForTest;
using test::DatagramSender;
using test::kPatience;
using Bytes = std::vector<std::uint8_t>;

Bytes RtpsHeader() {
  return {'R', 'T', 'P', 'S', 2, 3, 1, 15, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7};
}

unsigned long long RejectedDatagrams(Bus& bus) {
  const thalweg_msgs::msg::ServiceHealth health = bus.health().ToMessage(Time{});
  for (const auto& counter : health.rejected()) {
    if (counter.name() == Health::kDatagrams) return counter.count();
  }
  return 0;
}

/// A bus that publishes its health, and so counts what it refuses, over UDP alone.
BusOptions UdpOptions(const std::string& name) {
  BusOptions options = BusOptionsForTest(name);
  options.shared_memory = false;
  options.publish_health = true;
  return options;
}

TEST(Strangers, MalformedDatagramsAreCountedAndNothingElseHappens) {
  const BusOptions options = UdpOptions("victim");
  Bus victim(options);
  Bus peer(UdpOptions("peer"));
  std::string heard;
  victim.Subscribe<topics::MotionStatus>([&](const auto& m) { heard = m.reason(); });
  const auto status = peer.Advertise<topics::MotionStatus>();
  AwaitMatch(peer, status, victim);

  const DatagramSender stranger(options.domain);
  Bytes statistics = RtpsHeader();  // ends the process of an unguarded Fast DDS 2.9.1
  statistics.resize(84);
  statistics[20] = 0x80;
  statistics[21] = 1;
  statistics[22] = 56;
  stranger.Send(statistics);
  stranger.Send(Bytes(100, 'x'));
  std::mt19937 random(1);
  for (int k = 0; k < 300; ++k) {
    Bytes noise = RtpsHeader();
    const std::size_t size = 4 + random() % 80;
    for (std::size_t n = 0; n < size; ++n) noise.push_back(static_cast<std::uint8_t>(random()));
    stranger.Send(noise);
  }
  EXPECT_TRUE(victim.SpinUntil([&] { return RejectedDatagrams(victim) > 100; }, kPatience));

  thalweg_msgs::msg::MotionStatus message;
  message.reason("still here");
  status.Write(message);
  EXPECT_TRUE(victim.SpinUntil([&] { return heard == "still here"; }, kPatience));
}

/// Parts of an RTPS message in little-endian order.
class MessageParts {
 public:
  MessageParts& Add(const Bytes& bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  template <class Number>
  MessageParts& Add(Number number) {
    for (std::size_t k = 0; k < sizeof number; ++k) {
      bytes_.push_back(static_cast<std::uint8_t>(number >> (8 * k)));
    }
    return *this;
  }
  MessageParts& SequenceNumber(std::uint64_t number) {
    return Add(static_cast<std::uint32_t>(number >> 32U)).Add(static_cast<std::uint32_t>(number));
  }
  MessageParts& Submessage(std::uint8_t kind, std::uint8_t flags, const MessageParts& body) {
    return Add(kind).Add(flags).Add(static_cast<std::uint16_t>(body.bytes_.size())).Add(body.bytes_);
  }
  MessageParts& Parameter(std::uint16_t id, const MessageParts& value) {
    return Add(id).Add(static_cast<std::uint16_t>(value.bytes_.size())).Add(value.bytes_);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

const Bytes kForgersPrefix = {7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7};
const Bytes kToPublications = {0, 0, 3, 0xc7, 0, 0, 3, 0xc2};  // reader and writer of discovery

/// Announces a participant whose discovery is then matched [RTPS 2.3, section 8.5.3].
Bytes Announcement() {
  const MessageParts address =
      MessageParts().Add(std::uint32_t{1}).Add(std::uint32_t{1}).Add(Bytes(12)).Add(Bytes{127, 0, 0, 1});
  const Bytes id = MessageParts().Add(kForgersPrefix).Add(Bytes{0, 0, 1, 0xc1}).bytes();
  MessageParts payload;
  payload.Add(Bytes{0, 3, 0, 0})
      .Parameter(0x15, MessageParts().Add(Bytes{2, 3, 0, 0}))
      .Parameter(0x16, MessageParts().Add(Bytes{1, 15, 0, 0}))
      .Parameter(0x50, MessageParts().Add(id))
      .Parameter(0x32, address)
      .Parameter(0x31, address)
      .Parameter(0x02, MessageParts().Add(std::uint32_t{1000}).Add(std::uint32_t{0}))
      .Parameter(0x58, MessageParts().Add(std::uint32_t{0x3f}))
      .Parameter(0x01, MessageParts());
  return MessageParts()
      .Add(RtpsHeader())
      .Submessage(0x15, 5,
                  MessageParts()
                      .Add(Bytes{0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2})
                      .SequenceNumber(1)
                      .Add(payload.bytes()))
      .bytes();
}

Bytes Fragment(std::uint32_t first, std::uint16_t count, std::uint16_t size, std::uint32_t sample,
               std::size_t bytes) {
  MessageParts body;
  body.Add(Bytes{0, 0, 28, 0}).Add(kToPublications).SequenceNumber(1);
  body.Add(first).Add(count).Add(size).Add(sample).Add(Bytes(bytes));
  return MessageParts().Add(RtpsHeader()).Submessage(0x16, 1, body).bytes();
}

Bytes Gap(std::uint64_t start, std::uint64_t base) {
  MessageParts body;
  body.Add(kToPublications).SequenceNumber(start).SequenceNumber(base).Add(std::uint32_t{0});
  return MessageParts().Add(RtpsHeader()).Submessage(0x08, 1, body).bytes();
}

Bytes Heartbeat(std::uint64_t first, std::uint64_t last) {
  MessageParts body;
  body.Add(kToPublications).SequenceNumber(first).SequenceNumber(last).Add(std::uint32_t{9});
  return MessageParts().Add(RtpsHeader()).Submessage(0x07, 1, body).bytes();
}

TEST(Strangers, ForgedFragmentsGapsAndHeartbeatsNeitherEndNorStopABus) {
  const BusOptions options = UdpOptions("victim");
  Bus victim(options);
  const DatagramSender stranger(options.domain);
  // Before each, so that the victim reads the stranger's discovery when it comes. Each ended or stopped it.
  const std::vector<Bytes> attacks = {
      Fragment(1, 2000, 65'532, 2000 * 65'532, 4),  // claims 131 MB and has 4 bytes
      Fragment(1, 1, 60'000, 960'000, 60'000),  // a genuine beginning in 16 fragments; then as if of 8 bytes
      Fragment(1, 16, 8, 128, 128),
      Gap(1, std::uint64_t{1} << 56U),
      Gap(2, std::uint64_t{1} << 56U),
      Heartbeat(std::uint64_t{1} << 56U, std::uint64_t{1} << 56U),
      Heartbeat(std::uint64_t{1} << 39U, std::uint64_t{1} << 39U),
  };
  for (const Bytes& attack : attacks) {
    for (int k = 0; k < 3; ++k) stranger.Send(Announcement());
    stranger.Send(attack);
  }
  EXPECT_TRUE(victim.SpinUntil([&] { return RejectedDatagrams(victim) > 0; }, kPatience));

  Bus peer(UdpOptions("peer"));
  std::string heard;
  victim.Subscribe<topics::MotionStatus>([&](const auto& m) { heard = m.reason(); });
  const auto status = peer.Advertise<topics::MotionStatus>();
  AwaitMatch(peer, status, victim);
  thalweg_msgs::msg::MotionStatus message;
  message.reason("still here");
  status.Write(message);
  EXPECT_TRUE(victim.SpinUntil([&] { return heard == "still here"; }, kPatience));
}

TEST(Strangers, AmongFriendsNoDatagramIsRefused) {
  Bus reader(UdpOptions("reader"));
  Bus writer(UdpOptions("writer"));
  int heard = 0;
  reader.Subscribe<topics::MotionStatus>([&](const auto&) { ++heard; });
  reader.Subscribe<topics::MapUpdates>([&](const auto&) { ++heard; });
  const auto status = writer.Advertise<topics::MotionStatus>();
  const auto map = writer.Advertise<topics::MapUpdates>();
  AwaitMatch(writer, status, reader);
  AwaitMatch(writer, map, reader);
  thalweg_msgs::msg::MapUpdate large;  // in fragments
  large.blocks().resize(10'000);
  map.Write(large);
  status.Write({});
  ASSERT_TRUE(reader.SpinUntil([&] { return heard == 2; }, kPatience));
  // The reader of a writer that has nothing yet asks it again and again.
  const auto health = [](Bus& bus) { return bus.health().ToMessage(Time{}).uptime_s(); };
  const double then = health(writer) + 2.0;
  writer.SpinUntil([&] { return health(writer) > then; }, kPatience);
  reader.SpinUntil([&] { return health(reader) > then; }, kPatience);
  EXPECT_EQ(RejectedDatagrams(writer), 0U);
  EXPECT_EQ(RejectedDatagrams(reader), 0U);
}

TEST(Strangers, ASecondWriterOfATopicIsRefusedAndNamed) {
  Bus reader(BusOptionsForTest("reader"));
  Bus first(BusOptionsForTest("explorer"));
  std::vector<std::string> heard;
  reader.Subscribe<topics::MotionStatus>([&](const auto& m) { heard.push_back(m.reason()); });
  const auto genuine = first.Advertise<topics::MotionStatus>();
  AwaitMatch(first, genuine, reader);
  thalweg_msgs::msg::MotionStatus message;
  message.reason("genuine");
  genuine.Write(message);
  ASSERT_TRUE(reader.SpinUntil([&] { return heard.size() == 1; }, kPatience));

  Bus second(BusOptionsForTest("stranger"));
  const auto forged = second.Advertise<topics::MotionStatus>();
  ASSERT_TRUE(second.SpinUntil([&] { return forged.readers() == 1; }, kPatience));
  ASSERT_TRUE(reader.SpinUntil([&] { return reader.Writers<topics::MotionStatus>() == 2; }, kPatience));
  genuine.Write(message);
  ASSERT_TRUE(reader.SpinUntil([&] { return heard.size() == 2; }, kPatience));
  message.reason("forged");
  forged.Write(message);
  ASSERT_TRUE(reader.SpinUntil([&] { return reader.health().rejected() == 1; }, kPatience));
  const auto rejected = reader.health().ToMessage(Time{}).rejected();
  EXPECT_EQ(rejected[0].name(), "controller/status");
  EXPECT_NE(rejected[0].last().find("from \"stranger\""), std::string::npos) << rejected[0].last();
  EXPECT_NE(rejected[0].last().find("while \"explorer\""), std::string::npos) << rejected[0].last();
  EXPECT_EQ(heard, (std::vector<std::string>{"genuine", "genuine"}));
}

TEST(Strangers, AWriterThatComesAfterAnotherIsGoneIsReadAtOnce) {
  Bus reader(BusOptionsForTest("reader"));
  std::vector<std::string> heard;
  reader.Subscribe<topics::MotionStatus>([&](const auto& m) { heard.push_back(m.reason()); });
  thalweg_msgs::msg::MotionStatus message;
  for (const std::string name : {"first", "second"}) {
    Bus writer(BusOptionsForTest(name));
    const auto status = writer.Advertise<topics::MotionStatus>();
    message.reason(name);
    status.Write(message);
    ASSERT_TRUE(reader.SpinUntil([&] { return !heard.empty() && heard.back() == name; }, kPatience));
  }
  EXPECT_EQ(reader.health().rejected(), 0U);
}

TEST(Strangers, ASecondCopyOfAServiceEnds) {
  const auto options = [] {
    BusOptions its = BusOptionsForTest("mapper");
    its.publish_health = true;
    its.sole = true;
    return its;
  };
  const auto age_s = [](Bus& bus) { return bus.health().ToMessage(Time{}).uptime_s(); };
  Bus first(options());
  ASSERT_TRUE(first.SpinUntil([&] { return age_s(first) > 1.0; }, kPatience));
  Bus second(options());
  std::atomic<bool> ended = false;
  std::string error;
  std::thread spinning([&] {
    try {
      second.SpinUntil([] { return false; }, kPatience);
    } catch (const std::runtime_error& problem) {
      error = problem.what();
    }
    ended = true;
    first.Post([] {});
  });
  first.SpinUntil([&] { return ended.load(); }, kPatience);
  spinning.join();
  const std::string expected =
      "another mapper runs in this domain already: process " + std::to_string(getpid()) + " on ";
  EXPECT_EQ(error.substr(0, expected.size()), expected);
}

/// A writer that is not a bus, e.g. a driver of ROS 2.
template <class Topic>
class OtherWriter {
 public:
  OtherWriter(const BusOptions& options, fastdds::ReliabilityQosPolicyKind reliability)
      : participant_(fastdds::DomainParticipantFactory::get_instance()->create_participant(
            static_cast<std::uint32_t>(options.domain), fastdds::PARTICIPANT_QOS_DEFAULT)) {
    fastdds::TypeSupport type(TypeSupportOf<Topic>().release());
    type.register_type(participant_);
    fastdds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.partition.c_str());
    auto* const topic = participant_->create_topic(std::string("rt/") + Topic::kName, type.get_type_name(),
                                                   fastdds::TOPIC_QOS_DEFAULT);
    fastdds::DataWriterQos qos;
    qos.reliability().kind = reliability;
    qos.durability().kind = Topic::kDelivery == Delivery::kState ? fastdds::TRANSIENT_LOCAL_DURABILITY_QOS
                                                                 : fastdds::VOLATILE_DURABILITY_QOS;
    qos.data_sharing().off();
    writer_ = participant_->create_publisher(publisher_qos)->create_datawriter(topic, qos);
  }
  ~OtherWriter() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  OtherWriter(const OtherWriter&) = delete;
  OtherWriter& operator=(const OtherWriter&) = delete;

  /// @param clock_ahead  How far the clock of the writer's machine is ahead.
  void Publish(MessageOf<Topic> message, Duration clock_ahead = {}) const {
    const auto now = std::chrono::system_clock::now() + clock_ahead;
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
    const eprosima::fastrtps::Time_t stamp(static_cast<std::int32_t>(ns / 1'000'000'000),
                                           static_cast<std::uint32_t>(ns % 1'000'000'000));
    writer_->write_w_timestamp(&message, eprosima::fastrtps::rtps::c_InstanceHandle_Unknown, stamp);
  }

 private:
  fastdds::DomainParticipant* participant_;
  fastdds::DataWriter* writer_ = nullptr;
};

TEST(Strangers, ADriverThatOffersBestEffortIsRead) {
  const BusOptions options = BusOptionsForTest("mapper");
  Bus mapper(options);
  int heard = 0;
  int from_other = 0;
  mapper.Subscribe<topics::DepthPoints>([&](const auto& m) {
    ++heard;
    if (m.width() == 7) ++from_other;
  });
  const OtherWriter<topics::DepthPoints> driver(options, fastdds::BEST_EFFORT_RELIABILITY_QOS);
  ASSERT_TRUE(mapper.SpinUntil([&] { return mapper.Writers<topics::DepthPoints>() == 1; }, kPatience));
  // What is sent before the driver, too, knows of the match is lost.
  mapper.EveryWall(std::chrono::milliseconds(20), [&] { driver.Publish({}); });
  EXPECT_TRUE(mapper.SpinUntil([&] { return heard > 0; }, kPatience));

  // A reliable one is read as such, and then alone.
  const OtherWriter<topics::DepthPoints> other(options, fastdds::RELIABLE_RELIABILITY_QOS);
  sensor_msgs::msg::PointCloud2 cloud;
  cloud.width(7);
  mapper.EveryWall(std::chrono::milliseconds(20), [&] { other.Publish(cloud); });
  EXPECT_TRUE(mapper.SpinUntil([&] { return from_other > 3 && mapper.Writers<topics::DepthPoints>() == 1; },
                               kPatience));
}

TEST(Strangers, ACommandOfAMachineWithAnotherClockIsHeard) {
  const BusOptions options = BusOptionsForTest("controller");
  for (const auto ahead : {std::chrono::milliseconds(-900), std::chrono::milliseconds(900)}) {
    Bus controller(options);
    int heard = 0;
    controller.Subscribe<topics::Path>([&](const auto&) { ++heard; });
    const OtherWriter<topics::Path> explorer(options, fastdds::RELIABLE_RELIABILITY_QOS);
    ASSERT_TRUE(controller.SpinUntil([&] { return controller.Writers<topics::Path>() == 1; }, kPatience));
    controller.EveryWall(std::chrono::milliseconds(100), [&] { explorer.Publish({}, ahead); });
    EXPECT_TRUE(controller.SpinUntil([&] { return heard > 0; }, kPatience));
    const auto has_said_so = [&] {
      const auto timings = controller.health().ToMessage(Time{}).timings();
      const char* const name =
          ahead.count() > 0 ? "clock behind that of explorer/path" : "clock ahead of that of explorer/path";
      return !timings.empty() && timings[0].name() == name && timings[0].max_ms() > 800.0 &&
             timings[0].max_ms() < 1000.0;
    };
    EXPECT_TRUE(controller.SpinUntil(has_said_so, kPatience));
  }
}

TEST(Strangers, AFloodDoesNotHideWhatTheGenuineWriterSends) {
  const BusOptions options = BusOptionsForTest("mapper");
  Bus mapper(options);
  std::vector<std::uint32_t> heard;
  mapper.Subscribe<topics::DepthPoints>([&](const auto& m) { heard.push_back(m.width()); });
  const OtherWriter<topics::DepthPoints> genuine(options, fastdds::RELIABLE_RELIABILITY_QOS);
  ASSERT_TRUE(mapper.SpinUntil([&] { return mapper.Writers<topics::DepthPoints>() == 1; }, kPatience));
  const auto cloud = [](std::uint32_t width) {
    sensor_msgs::msg::PointCloud2 its;
    its.width(width);
    return its;
  };
  mapper.EveryWall(std::chrono::milliseconds(10), [&] {
    if (heard.empty()) genuine.Publish(cloud(1));
  });
  ASSERT_TRUE(mapper.SpinUntil([&] { return !heard.empty(); }, kPatience));
  const OtherWriter<topics::DepthPoints> forger(options, fastdds::RELIABLE_RELIABILITY_QOS);
  ASSERT_TRUE(mapper.SpinUntil([&] { return mapper.Writers<topics::DepthPoints>() == 2; }, kPatience));
  // After each genuine one come four forged ones, from the future, before the mapper looks.
  mapper.EveryWall(std::chrono::milliseconds(50), [&] {
    genuine.Publish(cloud(1));
    for (int k = 0; k < 4; ++k) forger.Publish(cloud(2), std::chrono::seconds(5));
  });
  EXPECT_TRUE(mapper.SpinUntil([&] { return heard.size() >= 30; }, kPatience));
  EXPECT_EQ(std::ranges::count(heard, 2U), 0);
  EXPECT_GT(mapper.health().rejected(), 30U);
}

TEST(Strangers, AServiceIsKeptFromStartingOnlyByAParticipantOfItsName) {
  BusOptions options = BusOptionsForTest("mapper");
  options.publish_health = true;
  options.sole = true;
  Bus mapper(options);
  Bus stranger(BusOptionsForTest("stranger"));
  const auto health_out = stranger.Advertise<topics::Health>();
  int heard = 0;
  mapper.Subscribe<topics::Health>([&](const auto& m) { heard += m.host() == "nowhere" ? 1 : 0; });
  AwaitMatch(stranger, health_out, mapper);
  thalweg_msgs::msg::ServiceHealth lie;
  lie.service("mapper");
  lie.host("nowhere");
  lie.uptime_s(1e9);
  mapper.EveryWall(std::chrono::milliseconds(20), [&] { health_out.Write(lie); });
  EXPECT_NO_THROW(EXPECT_TRUE(mapper.SpinUntil([&] { return heard > 2; }, kPatience)));
}

/// Hears a service on `Topic`, then a driver beside it that offers best effort only.
template <class Topic>
void ExpectBothAreRecorded() {
  const BusOptions options = BusOptionsForTest("recorder");
  Bus recorder(options);
  Bus service(BusOptionsForTest("service"));
  const auto reliable = service.Advertise<Topic>();
  std::vector<Time> heard;
  recorder.SubscribeBytes(
      InfoOf<Topic>(), [&](const RawSample& sample) { heard.push_back(sample.source_stamp); },
      Keep::kForRecording);
  AwaitMatch(service, reliable, recorder);
  for (int k = 0; k < 3; ++k) reliable.Write({});
  ASSERT_TRUE(reliable.AwaitDelivery(kPatience)) << Topic::kName;  // still in the reader when the driver comes
  const OtherWriter<Topic> driver(options, fastdds::BEST_EFFORT_RELIABILITY_QOS);
  ASSERT_TRUE(recorder.SpinUntil([&] { return recorder.Writers<Topic>() == 2; }, kPatience)) << Topic::kName;
  EXPECT_TRUE(recorder.SpinUntil([&] { return heard.size() >= 3; }, kPatience)) << Topic::kName;
  const std::size_t before = heard.size();
  recorder.EveryWall(std::chrono::milliseconds(20), [&] { driver.Publish({}); });
  EXPECT_TRUE(recorder.SpinUntil([&] { return heard.size() > before + 1; }, kPatience)) << Topic::kName;
}

TEST(Strangers, ADriverThatOffersBestEffortIsRecordedBesideAServiceOnEveryKindOfTopic) {
  ExpectBothAreRecorded<topics::DepthPoints>();
  ExpectBothAreRecorded<topics::Odometry>();
  ExpectBothAreRecorded<topics::MapUpdates>();
  ExpectBothAreRecorded<topics::MotionStatus>();
}

}  // namespace
}  // namespace thalweg::dds
