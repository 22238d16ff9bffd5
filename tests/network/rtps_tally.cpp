#include "tests/network/rtps_tally.h"

#include <algorithm>
#include <cstring>
#include <optional>

namespace thalweg::network {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Ethernet and IPv4 [RFC 791], lengths and offsets in bytes.
constexpr std::size_t kEthernetHeader = 14;
constexpr std::size_t kLeastIpHeader = 20;
constexpr std::size_t kUdpHeader = 8;
constexpr std::uint16_t kIpv4 = 0x0800;
constexpr std::uint16_t kArp = 0x0806;
constexpr std::uint8_t kUdp = 17;
constexpr std::uint16_t kMoreFragments = 0x2000;
constexpr std::uint16_t kFragmentOffset = 0x1fff;
// Datagrams whose last fragment never came must not accumulate.
constexpr std::size_t kMostUnfinished = 1024;

// RTPS 2.2, Sec. 9.4.5.
constexpr std::size_t kRtpsHeader = 20;
constexpr std::size_t kSubmessageHeader = 4;
constexpr std::uint8_t kAckNack = 0x06;
constexpr std::uint8_t kHeartbeat = 0x07;
constexpr std::uint8_t kGap = 0x08;
constexpr std::uint8_t kInfoDestination = 0x0e;
constexpr std::uint8_t kNackFrag = 0x12;
constexpr std::uint8_t kHeartbeatFrag = 0x13;
constexpr std::uint8_t kData = 0x15;
constexpr std::uint8_t kDataFrag = 0x16;
constexpr std::uint8_t kLittleEndian = 0x01;
constexpr std::uint8_t kInlineQos = 0x02;
// Sec. 9.3.1.2: the upper two bits of the last byte of an entity ID mark those of the protocol itself.
constexpr std::uint32_t kBuiltin = 0xc0;
constexpr std::uint32_t kPublicationsWriter = 0x000003c2;
// Sec. 9.6.2.2: parameters of discovered writers.
constexpr std::uint16_t kParameterSentinel = 0x0001;
constexpr std::uint16_t kParameterTopicName = 0x0005;
constexpr std::uint16_t kParameterEndpointGuid = 0x005a;

const std::string kUnknown = "unknown";
const std::string kDiscovery = "discovery";

std::uint16_t BigEndian16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

std::uint32_t BigEndian32(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(BigEndian16(bytes, at)) << 16 | BigEndian16(bytes, at + 2);
}

std::uint16_t Read16(Bytes bytes, std::size_t at, bool little) {
  const std::uint16_t value = BigEndian16(bytes, at);
  return little ? static_cast<std::uint16_t>(value << 8 | value >> 8) : value;
}

std::uint32_t Read32(Bytes bytes, std::size_t at, bool little) {
  const std::uint32_t value = BigEndian32(bytes, at);
  return little ? __builtin_bswap32(value) : value;
}

std::array<std::uint8_t, 12> PrefixAt(Bytes bytes, std::size_t at) {
  std::array<std::uint8_t, 12> prefix;
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), prefix.size(), prefix.begin());
  return prefix;
}

void Add(TopicCount& count, std::uint64_t bytes, std::uint64_t packets) {
  count.bytes += bytes;
  count.packets += packets;
}

}  // namespace

/// One submessage, as far as the frame contains it.
struct RtpsTally::Submessage {
  std::uint8_t kind;
  std::uint8_t flags;
  Bytes body;

  bool little() const { return (flags & kLittleEndian) != 0; }
  /// Where the writer's entity ID stands; nothing if the submessage is not about one.
  std::optional<std::size_t> WriterAt() const {
    std::size_t at = 4;  // after the reader's
    switch (kind) {
      case kData:
      case kDataFrag:
        at = 8;
        break;
      case kAckNack:
      case kHeartbeat:
      case kGap:
      case kNackFrag:
      case kHeartbeatFrag:
        break;
      default:
        return std::nullopt;
    }
    if (at + 4 > body.size()) return std::nullopt;
    return at;
  }
  bool IsFromReader() const { return kind == kAckNack || kind == kNackFrag; }
  bool IsSample() const { return kind == kData || kind == kDataFrag; }
};

namespace {

/// Header length of an IPv4 packet; 0 if it is not one that carries UDP.
std::size_t UdpOffset(Bytes ip) {
  const std::size_t header = std::size_t{4} * (ip[0] & 0x0fU);
  return ip[9] == kUdp && header >= kLeastIpHeader && header <= ip.size() ? header : 0;
}

bool IsRtps(Bytes message) {
  return message.size() >= kRtpsHeader && std::memcmp(message.data(), "RTPS", 4) == 0;
}

}  // namespace

void RtpsTally::Count(Direction direction, std::span<const std::uint8_t> frame) {
  auto& topics = topics_.at(direction);
  const auto count_as = [&](const std::string& name) { Add(topics[name], frame.size(), 1); };
  if (frame.size() < kEthernetHeader + kLeastIpHeader) return count_as("other");
  const std::uint16_t protocol = BigEndian16(frame, 12);
  if (protocol == kArp) return count_as("arp");
  if (protocol != kIpv4) return count_as("other");

  const Bytes ip = frame.subspan(kEthernetHeader);
  const std::size_t udp = UdpOffset(ip);
  if (udp == 0) return count_as("other");
  const std::uint16_t fragment = BigEndian16(ip, 6);
  const Datagram datagram{BigEndian32(ip, 12), BigEndian32(ip, 16), BigEndian16(ip, 4)};
  if ((fragment & kFragmentOffset) != 0) return CountLaterFragment(direction, datagram, ip, frame.size());

  const Bytes message = ip.subspan(std::min(ip.size(), udp + kUdpHeader));
  Unfinished unfinished{.name = "other udp", .message = {}};
  if (IsRtps(message)) {
    unfinished.name = CountRtps(direction, message, frame.size());
    if (unfinished.name == kDiscovery) unfinished.message.assign(message.begin(), message.end());
  } else {
    count_as(unfinished.name);
  }
  if ((fragment & kMoreFragments) == 0) return;
  if (unfinished_.size() >= kMostUnfinished) unfinished_.clear();
  unfinished_[datagram] = std::move(unfinished);
}

void RtpsTally::CountLaterFragment(Direction direction, const Datagram& datagram, Bytes ip,
                                   std::size_t frame_bytes) {
  const auto begun = unfinished_.find(datagram);
  Add(topics_.at(direction)[begun == unfinished_.end() ? kUnknown : begun->second.name], frame_bytes, 1);
  if (begun == unfinished_.end()) return;

  const std::uint16_t fragment = BigEndian16(ip, 6);
  std::vector<std::uint8_t>& message = begun->second.message;
  const Bytes content = ip.subspan(UdpOffset(ip));
  const std::size_t offset = std::size_t{8} * (fragment & kFragmentOffset);
  const bool continues = !message.empty() && offset == kUdpHeader + message.size();
  if (continues) message.insert(message.end(), content.begin(), content.end());
  if (!continues) message.clear();
  if ((fragment & kMoreFragments) != 0) return;
  if (!message.empty()) LearnWriters(message);
  unfinished_.erase(begun);
}

/// Calls handle(submessage, source, destination) for each submessage, the last as far as it is there.
template <class Handle>
void RtpsTally::ForEachSubmessage(Bytes message, Handle&& handle) {
  const GuidPrefix source = PrefixAt(message, 8);
  GuidPrefix destination{};
  for (std::size_t at = kRtpsHeader; at + kSubmessageHeader <= message.size();) {
    const std::uint8_t flags = message[at + 1];
    const std::size_t stated = Read16(message, at + 2, (flags & kLittleEndian) != 0);
    const std::size_t rest = message.size() - at - kSubmessageHeader;
    // A length of 0 means: up to the end of the message; so does one beyond it, in a first fragment.
    const std::size_t length = stated == 0 ? rest : std::min(stated, rest);
    const Submessage submessage{message[at], flags, message.subspan(at + kSubmessageHeader, length)};
    at += kSubmessageHeader + length;
    if (submessage.kind == kInfoDestination && length >= destination.size()) {
      destination = PrefixAt(submessage.body, 0);
    }
    handle(submessage, source, destination);
  }
}

std::string RtpsTally::CountRtps(Direction direction, Bytes message, std::size_t frame_bytes) {
  auto& topics = topics_.at(direction);
  std::string first;  // topic of the first submessage about one, to which the headers are charged
  std::string last = kDiscovery;
  std::size_t charged = 0;
  ForEachSubmessage(
      message, [&](const Submessage& submessage, const GuidPrefix& source, const GuidPrefix& destination) {
        const std::optional<std::size_t> writer_at = submessage.WriterAt();
        if (!writer_at) return;
        const Guid writer{submessage.IsFromReader() ? destination : source,
                          BigEndian32(submessage.body, *writer_at)};
        if (writer.entity == kPublicationsWriter) LearnWriter(submessage, source);
        last = NameOf(writer);
        if (first.empty()) first = last;
        const std::size_t bytes = kSubmessageHeader + submessage.body.size();
        TopicCount& count = topics[last];
        count.bytes += bytes;
        charged += bytes;
        if (submessage.IsSample()) CountSample(submessage, writer, count);
      });
  Add(topics[first.empty() ? last : first], frame_bytes - charged, 1);
  return last;
}

void RtpsTally::LearnWriters(Bytes message) {
  ForEachSubmessage(message, [&](const Submessage& submessage, const GuidPrefix& source, const GuidPrefix&) {
    const std::optional<std::size_t> writer_at = submessage.WriterAt();
    if (writer_at && BigEndian32(submessage.body, *writer_at) == kPublicationsWriter) {
      LearnWriter(submessage, source);
    }
  });
}

void RtpsTally::CountSample(const Submessage& submessage, const Guid& writer, TopicCount& count) {
  constexpr std::size_t kNumberAt = 12;
  if ((writer.entity & kBuiltin) == kBuiltin || submessage.body.size() < kNumberAt + 8) return;
  const std::uint64_t high = Read32(submessage.body, kNumberAt, submessage.little());
  const std::uint64_t low = Read32(submessage.body, kNumberAt + 4, submessage.little());
  const auto number = static_cast<std::int64_t>(high << 32 | low);
  const auto [newest, is_first] = newest_sample_.try_emplace(writer, number);
  if (!is_first && number <= newest->second) return;
  newest->second = number;
  ++count.samples;
}

void RtpsTally::LearnWriter(const Submessage& submessage, const GuidPrefix& announcer) {
  constexpr std::size_t kQosOffsetAt = 2;  // counted from the end of the field itself
  if (submessage.kind != kData) return;
  const Bytes body = submessage.body;
  std::size_t at = kQosOffsetAt + 2 + Read16(body, kQosOffsetAt, submessage.little());
  bool little = submessage.little();
  std::string topic;
  Guid writer{announcer, 0};
  const auto read_list = [&] {
    while (at + 4 <= body.size()) {
      const std::uint16_t parameter = Read16(body, at, little);
      const std::size_t length = Read16(body, at + 2, little);
      at += 4;
      if (parameter == kParameterSentinel || at + length > body.size()) return;
      if (parameter == kParameterTopicName && length > 4) {
        const std::size_t size = std::min<std::size_t>(Read32(body, at, little), length - 4);
        topic.assign(body.begin() + static_cast<std::ptrdiff_t>(at + 4),
                     body.begin() + static_cast<std::ptrdiff_t>(at + 4 + size));
        topic.erase(std::ranges::find(topic, '\0'), topic.end());
      } else if (parameter == kParameterEndpointGuid && length >= 16) {
        writer = {PrefixAt(body, at), BigEndian32(body, at + 12)};
      }
      at += length;
    }
  };
  if ((submessage.flags & kInlineQos) != 0) read_list();
  if (at + 4 > body.size()) return;
  little = body[at + 1] == 3;  // PL_CDR_LE; PL_CDR_BE is 2
  at += 4;
  read_list();
  if (writer.entity == 0 || topic.empty()) return;
  writers_[writer] = topic.starts_with("rt/") ? topic.substr(3) : topic;
}

const std::string& RtpsTally::NameOf(const Guid& writer) const {
  if ((writer.entity & kBuiltin) == kBuiltin) return kDiscovery;
  const auto known = writers_.find(writer);
  return known == writers_.end() ? kUnknown : known->second;
}

}  // namespace thalweg::network
