#include "tests/network/rtps_tally.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace thalweg::network {
namespace {

using testing::Contains;
using testing::Key;
using Frame = std::vector<std::uint8_t>;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kCloudWriter = 0x00000103;
constexpr std::uint32_t kPublicationsWriter = 0x000003c2;
constexpr std::size_t kHeaders = 14 + 20 + 8 + 20;  // Ethernet, IP, UDP, RTPS

void Append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}
void Append16(Bytes& to, std::uint16_t value, bool little) {
  const auto low = static_cast<std::uint8_t>(value & 0xff);
  const auto high = static_cast<std::uint8_t>(value >> 8);
  Append(to, little ? Bytes{low, high} : Bytes{high, low});
}
void Append32(Bytes& to, std::uint32_t value, bool little) {
  const auto low = static_cast<std::uint16_t>(value & 0xffff);
  const auto high = static_cast<std::uint16_t>(value >> 16);
  Append16(to, little ? low : high, little);
  Append16(to, little ? high : low, little);
}

Bytes Prefix(std::uint8_t participant) {
  return Bytes(12, participant);
}

Bytes Submessage(std::uint8_t kind, const Bytes& body, bool little) {
  Bytes bytes{kind, static_cast<std::uint8_t>(little ? 0x05 : 0x04)};
  Append16(bytes, static_cast<std::uint16_t>(body.size()), little);
  Append(bytes, body);
  return bytes;
}

/// DATA [RTPS 2.2, Sec. 9.4.5.3].
Bytes Data(std::uint32_t writer, std::uint32_t number, const Bytes& payload, bool little = true) {
  Bytes body;
  Append16(body, 0, little);
  Append16(body, 16, little);
  Append32(body, 0, false);
  Append32(body, writer, false);
  Append32(body, 0, little);
  Append32(body, number, little);
  Append(body, payload);
  return Submessage(0x15, body, little);
}

/// What a participant says of its writer [Sec. 9.6.2.2].
Bytes Announcement(std::uint8_t participant, std::uint32_t writer, const std::string& topic, bool little) {
  Bytes payload{0, static_cast<std::uint8_t>(little ? 3 : 2), 0, 0};
  Append16(payload, 0x0005, little);
  const std::size_t padded = (topic.size() + 1 + 3) / 4 * 4;
  Append16(payload, static_cast<std::uint16_t>(4 + padded), little);
  Append32(payload, static_cast<std::uint32_t>(topic.size() + 1), little);
  Bytes text(topic.begin(), topic.end());
  text.resize(padded, 0);
  Append(payload, text);
  Append16(payload, 0x005a, little);
  Append16(payload, 16, little);
  Append(payload, Prefix(participant));
  Append32(payload, writer, false);
  Append16(payload, 1, little);
  Append16(payload, 0, little);
  return Data(kPublicationsWriter, 1, payload, little);
}

Bytes AckNack(std::uint8_t writers_participant, std::uint32_t writer) {
  Bytes body;
  Append32(body, 0, false);
  Append32(body, writer, false);
  Append(body, Bytes(16, 0));
  Bytes bytes = Submessage(0x0e, Prefix(writers_participant), true);
  Append(bytes, Submessage(0x06, body, true));
  return bytes;
}

/// A frame with the first part of a datagram, or all of it.
Frame FrameOf(std::uint8_t participant, const Bytes& submessages, bool more = false, std::uint16_t id = 1) {
  Frame frame(12, 0);
  Append16(frame, 0x0800, false);
  Append(frame, {0x45, 0, 0, 0});
  Append16(frame, id, false);
  Append16(frame, more ? 0x2000 : 0, false);
  Append(frame, {64, 17, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2});
  Append(frame, Bytes(8, 0));
  Append(frame, {'R', 'T', 'P', 'S', 2, 2, 1, 15});
  Append(frame, Prefix(participant));
  Append(frame, submessages);
  return frame;
}

/// @param offset  Offset of the content within the datagram.
Frame LaterFragment(std::uint16_t id, bool more, std::size_t offset, const Bytes& content) {
  Frame frame(12, 0);
  Append16(frame, 0x0800, false);
  Append(frame, {0x45, 0, 0, 0});
  Append16(frame, id, false);
  Append16(frame, static_cast<std::uint16_t>((more ? 0x2000 : 0) | offset / 8), false);
  Append(frame, {64, 17, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2});
  Append(frame, content);
  return frame;
}

class RtpsTallyTest : public testing::TestWithParam<bool> {
 protected:
  RtpsTallyTest() { Count(FrameOf(1, Announcement(1, kCloudWriter, "rt/depth/points", GetParam()))); }
  void Count(const Frame& frame) { tally_.Count(RtpsTally::kFirst, frame); }
  TopicCount Clouds() const { return At("depth/points"); }
  TopicCount At(const std::string& topic) const {
    const auto& topics = tally_.topics(RtpsTally::kFirst);
    return topics.contains(topic) ? topics.at(topic) : TopicCount{};
  }
  RtpsTally tally_;
};

TEST_P(RtpsTallyTest, KnowsATopicFromTheAnnouncementOfItsWriter) {
  const Frame frame = FrameOf(1, Data(kCloudWriter, 1, Bytes(100, 0), GetParam()));
  Count(frame);
  EXPECT_EQ(Clouds().bytes, frame.size());
  EXPECT_EQ(Clouds().packets, 1U);
  EXPECT_EQ(Clouds().samples, 1U);
  EXPECT_EQ(At("discovery").packets, 1U);
}

TEST_P(RtpsTallyTest, WriterOfAnotherParticipantIsUnknown) {
  Count(FrameOf(2, Data(kCloudWriter, 1, Bytes(100, 0), GetParam())));
  EXPECT_EQ(Clouds().packets, 0U);
  EXPECT_EQ(At("unknown").packets, 1U);
}

TEST_P(RtpsTallyTest, CountsASampleOnceHoweverOftenItIsRepeated) {
  for (const std::uint32_t number : {4, 5, 5, 4, 6}) {
    Count(FrameOf(1, Data(kCloudWriter, number, Bytes(100, 0), GetParam())));
  }
  EXPECT_EQ(Clouds().samples, 3U);
  EXPECT_EQ(Clouds().packets, 5U);
}

TEST_P(RtpsTallyTest, FragmentsBelongToTheTopicOfTheirDatagram) {
  Bytes data = Data(kCloudWriter, 1, Bytes(5000, 0), GetParam());
  data.resize(1472 - 20);  // the rest follows in other fragments
  const Frame first = FrameOf(1, data, true, 9);
  Count(first);
  Count(LaterFragment(9, true, 1480, Bytes(1480, 0)));
  Count(LaterFragment(9, false, 2960, Bytes(700, 0)));
  Count(LaterFragment(9, false, 2960, Bytes(60, 0)));  // of a datagram that has ended
  EXPECT_EQ(Clouds().bytes, first.size() + (34 + 1480) + (34 + 700));
  EXPECT_EQ(At("unknown").bytes, 34U + 60U);
}

TEST_P(RtpsTallyTest, AnnouncementsAreReadInLaterFragmentsToo) {
  Bytes announcements;
  for (std::uint32_t writer = 1; writer <= 40; ++writer) {
    Append(announcements, Announcement(3, writer << 8 | 3, "rt/topic" + std::to_string(writer), GetParam()));
  }
  constexpr std::size_t kHeadersWithin = 8 + 20;  // UDP, RTPS
  constexpr std::size_t kFragment = 1480;
  const auto cut = [&](std::size_t from, std::size_t to) {
    return Bytes(announcements.begin() + static_cast<std::ptrdiff_t>(from),
                 announcements.begin() + static_cast<std::ptrdiff_t>(std::min(to, announcements.size())));
  };
  Count(FrameOf(3, cut(0, kFragment - kHeadersWithin), true, 5));
  for (std::size_t at = kFragment; at < announcements.size() + kHeadersWithin; at += kFragment) {
    const bool more = at + kFragment < announcements.size() + kHeadersWithin;
    Count(LaterFragment(5, more, at, cut(at - kHeadersWithin, at + kFragment - kHeadersWithin)));
  }
  Count(FrameOf(3, Data(40 << 8 | 3, 1, Bytes(100, 0), GetParam())));
  EXPECT_EQ(At("topic40").samples, 1U);
}

TEST_P(RtpsTallyTest, AcknowledgmentsBelongToTheTopicTheyAcknowledge) {
  const Frame frame = FrameOf(2, AckNack(1, kCloudWriter));
  tally_.Count(RtpsTally::kSecond, frame);
  const auto& topics = tally_.topics(RtpsTally::kSecond);
  ASSERT_THAT(topics, Contains(Key("depth/points")));
  EXPECT_EQ(topics.at("depth/points").bytes, frame.size());
  EXPECT_EQ(topics.at("depth/points").samples, 0U);
}

TEST_P(RtpsTallyTest, TopicsThatShareADatagramShareItsBytes) {
  Count(FrameOf(1, Announcement(1, 0x203, "rt/odometry", GetParam())));
  const Bytes cloud = Data(kCloudWriter, 1, Bytes(100, 0), GetParam());
  const Bytes pose = Data(0x203, 1, Bytes(40, 0), GetParam());
  Bytes both = cloud;
  Append(both, pose);
  Count(FrameOf(1, both));
  EXPECT_EQ(Clouds().bytes, kHeaders + cloud.size());
  EXPECT_EQ(At("odometry").bytes, pose.size());
}

TEST_P(RtpsTallyTest, EveryByteIsCountedOnceWhateverItSays) {
  std::mt19937 random(3);
  std::uint64_t sent = 0;
  RtpsTally tally;
  for (int i = 0; i < 20'000; ++i) {
    Frame frame = FrameOf(1, i % 2 == 0 ? Announcement(1, kCloudWriter, "rt/depth/points", GetParam())
                                        : Data(kCloudWriter, i, Bytes(80, 0), GetParam()));
    for (int flips = static_cast<int>(random() % 8); flips > 0; --flips) {
      frame[random() % frame.size()] = static_cast<std::uint8_t>(random());
    }
    frame.resize(random() % 4 == 0 ? random() % frame.size() : frame.size());
    tally.Count(RtpsTally::kFirst, frame);
    sent += frame.size();
  }
  std::uint64_t counted = 0;
  std::uint64_t packets = 0;
  for (const auto& [name, count] : tally.topics(RtpsTally::kFirst)) {
    counted += count.bytes;
    packets += count.packets;
  }
  EXPECT_EQ(counted, sent);
  EXPECT_EQ(packets, 20'000U);
}

INSTANTIATE_TEST_SUITE_P(Endian, RtpsTallyTest, testing::Values(true, false),
                         [](const auto& endian) { return endian.param ? "Little" : "Big"; });

}  // namespace
}  // namespace thalweg::network
