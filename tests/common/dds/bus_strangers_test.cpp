#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
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
#include "tests/support/test_bus.h"

// What participants and datagrams that do not belong to the system can do to a bus.

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
using test::AwaitMatch;
using test::BusOptionsForTest;
using test::kPatience;
using Bytes = std::vector<std::uint8_t>;

/// Sends datagrams to all ports on which participants of a domain may listen [RTPS 2.3, section 9.6.1.1].
class DatagramSender {
 public:
  explicit DatagramSender(int domain)
      : first_port_(7400 + 250 * domain), socket_(socket(AF_INET, SOCK_DGRAM, 0)) {}
  ~DatagramSender() { close(socket_); }
  DatagramSender(const DatagramSender&) = delete;
  DatagramSender& operator=(const DatagramSender&) = delete;

  void Send(const Bytes& bytes) const {
    for (int offset = 10; offset < 40; ++offset) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(first_port_ + offset));
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }

 private:
  int first_port_;
  int socket_;
};

Bytes RtpsHeader() {
  return {'R', 'T', 'P', 'S', 2, 3, 1, 15, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7};
}

unsigned long long RejectedDatagrams(Bus& bus) {
  const thalweg_msgs::msg::ServiceHealth health = bus.health().ToMessage(Time{});
  for (const auto& counter : health.rejected()) {
    if (counter.name() == "datagram") return counter.count();
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

/// Publishes as many drivers do: as best effort.
template <class Topic>
class BestEffortDriver {
 public:
  explicit BestEffortDriver(const BusOptions& options)
      : participant_(fastdds::DomainParticipantFactory::get_instance()->create_participant(
            static_cast<std::uint32_t>(options.domain), fastdds::PARTICIPANT_QOS_DEFAULT)) {
    fastdds::TypeSupport type(new typename Topic::Type());
    type.register_type(participant_);
    fastdds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.partition.c_str());
    auto* const topic = participant_->create_topic(std::string("rt/") + Topic::kName, type.get_type_name(),
                                                   fastdds::TOPIC_QOS_DEFAULT);
    fastdds::DataWriterQos qos;
    qos.reliability().kind = fastdds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = Topic::kDelivery == Delivery::kState ? fastdds::TRANSIENT_LOCAL_DURABILITY_QOS
                                                                 : fastdds::VOLATILE_DURABILITY_QOS;
    qos.data_sharing().off();
    writer_ = participant_->create_publisher(publisher_qos)->create_datawriter(topic, qos);
  }
  ~BestEffortDriver() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  BestEffortDriver(const BestEffortDriver&) = delete;
  BestEffortDriver& operator=(const BestEffortDriver&) = delete;

  void Publish() const {
    MessageOf<Topic> message;
    writer_->write(&message);
  }

 private:
  fastdds::DomainParticipant* participant_;
  fastdds::DataWriter* writer_ = nullptr;
};

TEST(Strangers, ADriverThatOffersBestEffortIsRead) {
  const BusOptions options = BusOptionsForTest("mapper");
  Bus mapper(options);
  int heard = 0;
  mapper.Subscribe<topics::DepthPoints>([&](const auto&) { ++heard; });
  const BestEffortDriver<topics::DepthPoints> driver(options);
  ASSERT_TRUE(mapper.SpinUntil([&] { return mapper.Writers<topics::DepthPoints>() == 1; }, kPatience));
  // What is sent before the driver, too, knows of the match is lost.
  mapper.EveryWall(std::chrono::milliseconds(20), [&] { driver.Publish(); });
  EXPECT_TRUE(mapper.SpinUntil([&] { return heard > 0; }, kPatience));
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
  for (int k = 0; k < 3; ++k) reliable.Write({});  // still in the reader when the driver comes
  const BestEffortDriver<Topic> driver(options);
  ASSERT_TRUE(recorder.SpinUntil([&] { return recorder.Writers<Topic>() == 2; }, kPatience)) << Topic::kName;
  EXPECT_GE(heard.size(), 3U) << Topic::kName;
  const std::size_t before = heard.size();
  recorder.EveryWall(std::chrono::milliseconds(20), [&] { driver.Publish(); });
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
