#include "common/dds/rtps_message.h"

#include <algorithm>
#include <array>

namespace thalweg::dds {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Problem = std::optional<std::string_view>;

constexpr std::size_t kHeaderBytes = 20;
constexpr std::size_t kSubmessageHeaderBytes = 4;
constexpr std::size_t kStatisticsBytes = 56;
constexpr std::size_t kPrefixBytes = 12;  // of a participant's GUID
constexpr auto kBeyondLargest = "a sequence number beyond 2^40";

// RTPS 2.3, table 9.13, and the submessage by which Fast DDS counts traffic.
enum Kind : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoReplyIp4 = 0x0d,
  kInfoDestination = 0x0e,
  kInfoReply = 0x0f,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = 0x15,
  kDataFrag = 0x16,
  kFastDdsStatistics = 0x80,
};

// Parameters of the inline QoS [RTPS 2.3, table 9.14].
enum Parameter : std::uint16_t { kSentinel = 0x0001, kKeyHash = 0x0070, kStatusInfo = 0x0071 };

/// A submessage without its header.
struct Submessage {
  Kind kind;
  std::uint8_t flags;
  Bytes body;

  bool little_endian() const { return (flags & 0x01U) != 0; }
  std::uint16_t U16(std::size_t at) const {
    const unsigned first = body[at];
    const unsigned second = body[at + 1];
    return static_cast<std::uint16_t>(little_endian() ? first | second << 8U : first << 8U | second);
  }
  std::uint32_t U32(std::size_t at) const {
    const std::uint32_t first = U16(at);
    const std::uint32_t second = U16(at + 2);
    return little_endian() ? first | second << 16U : first << 16U | second;
  }
  std::int64_t SequenceNumber(std::size_t at) const {
    return static_cast<std::int64_t>(std::uint64_t{U32(at)} << 32U | U32(at + 4));
  }
};

constexpr std::string_view kTooShort = "a submessage shorter than its kind";

/// Bytes that the body of a submessage of this kind has at least.
std::size_t LeastBytes(const Submessage& submessage) {
  switch (submessage.kind) {
    case kAckNack:
      return 24;
    case kHeartbeat:
    case kGap:
    case kNackFrag:
      return 28;
    case kInfoTimestamp:
      return (submessage.flags & 0x02U) != 0 ? 0 : 8;
    case kInfoSource:
    case kData:
      return 20;
    case kInfoReplyIp4:
    case kInfoReply:
      return 8;
    case kInfoDestination:
      return 12;
    case kHeartbeatFrag:
      return 24;
    case kDataFrag:
      return 32;
    default:
      return 0;
  }
}

/// A set of `bits` numbers whose bitmap starts at `at`.
Problem CheckBitmap(const Submessage& submessage, std::size_t at, std::uint32_t bits, std::size_t behind) {
  if (bits > 256) return "a set of more than 256 numbers";
  const std::size_t bytes = (bits + 31U) / 32U * 4U;
  if (at + bytes + behind > submessage.body.size()) return "a set that ends beyond its submessage";
  return std::nullopt;
}

/// A SequenceNumberSet at `at`, with `behind` bytes after it.
Problem CheckNumbers(const Submessage& submessage, std::size_t at, std::size_t behind) {
  if (submessage.SequenceNumber(at) < 1) return "a set that begins before sequence number 1";
  if (submessage.SequenceNumber(at) > kLargestSequenceNumber + 1) return kBeyondLargest;
  return CheckBitmap(submessage, at + 12, submessage.U32(at + 8), behind);
}

/// Fast DDS asks a writer for its first heartbeat by an empty set that begins at 0.
Problem CheckAckNack(const Submessage& submessage) {
  const bool is_greeting = submessage.SequenceNumber(8) == 0 && submessage.U32(16) == 0;
  return is_greeting ? std::nullopt : CheckNumbers(submessage, 8, 4);
}

/// The inline QoS: parameters of a 4-byte header and a length, until the one with ID 1. @return Where they
/// end; nothing if that is beyond the submessage.
std::optional<std::size_t> EndOfParameters(const Submessage& submessage, std::size_t at) {
  while (at + 4 <= submessage.body.size()) {
    const std::uint16_t id = submessage.U16(at);
    const std::uint16_t length = submessage.U16(at + 2);
    at += 4;
    if (id == kSentinel) return at;
    at += length;
  }
  return std::nullopt;
}

/// The value of an inline QoS parameter of a well-formed submessage; empty if it does not have that one.
Bytes InlineQos(const Submessage& submessage, std::uint16_t wanted) {
  if ((submessage.flags & 0x02U) == 0) return {};
  std::size_t at = submessage.U16(2) + std::size_t{4};
  while (at + 4 <= submessage.body.size()) {
    const std::uint16_t id = submessage.U16(at);
    const std::uint16_t length = submessage.U16(at + 2);
    at += 4;
    if (id == kSentinel || at + length > submessage.body.size()) break;
    if (id == wanted) return submessage.body.subspan(at, length);
    at += length;
  }
  return {};
}

/// Data and DataFrag: what follows the fixed part, which `fixed` bytes of the body hold, has at least
/// `payload` bytes after its inline QoS.
Problem CheckPayload(const Submessage& submessage, std::size_t fixed, std::size_t payload) {
  const std::size_t to_inline_qos = submessage.U16(2) + std::size_t{4};
  if (to_inline_qos < fixed) return "inline QoS that begins within the header of its submessage";
  if (to_inline_qos > submessage.body.size()) return "inline QoS that begins beyond its submessage";
  std::size_t at = to_inline_qos;
  if ((submessage.flags & 0x02U) != 0) {
    const auto end = EndOfParameters(submessage, at);
    if (!end) return "inline QoS that does not end within its submessage";
    at = *end;
  }
  if (at + payload > submessage.body.size()) return "a payload that ends beyond its submessage";
  return std::nullopt;
}

Problem CheckSequenceNumber(std::int64_t number, std::string_view too_small) {
  if (number < 1) return too_small;
  if (number > kLargestSequenceNumber) return kBeyondLargest;
  return std::nullopt;
}

Problem CheckData(const Submessage& submessage) {
  const Problem problem =
      CheckSequenceNumber(submessage.SequenceNumber(12), "data with a sequence number below 1");
  if (problem) return problem;
  constexpr std::size_t kEncapsulationBytes = 4;
  const bool has_payload = (submessage.flags & 0x0cU) != 0;  // data or key
  return CheckPayload(submessage, 20, has_payload ? kEncapsulationBytes : 0);
}

Problem CheckDataFrag(const Submessage& submessage, const RtpsRules& rules) {
  const Problem problem =
      CheckSequenceNumber(submessage.SequenceNumber(12), "a fragment with a sequence number below 1");
  if (problem) return problem;
  const std::uint64_t first = submessage.U32(20);
  const std::uint64_t count = submessage.U16(24);
  const std::uint64_t fragment_bytes = submessage.U16(26);
  const std::uint64_t sample_bytes = submessage.U32(28);
  if ((submessage.flags & 0x04U) != 0) return "a fragment of a key";
  if (first < 1 || count < 1) return "a fragment without number or count";
  if (count > kMostFragments) return "more than 64 fragments in a submessage";
  // A reader keeps its list of missing fragments in their place, 4 bytes in each.
  if (fragment_bytes < 8 || fragment_bytes % 4 != 0) return "a fragment of a size that is not 8, 12, 16...";
  if (sample_bytes > rules.largest_sample) return "a fragment of a larger sample than any topic here has";
  const std::uint64_t fragments = (sample_bytes + fragment_bytes - 1) / fragment_bytes;
  if (first + count - 1 > fragments) return "a fragment beyond the end of its sample";
  const std::uint64_t rest = sample_bytes - (first - 1) * fragment_bytes;
  return CheckPayload(submessage, 32, std::min(count * fragment_bytes, rest));
}

Problem CheckGap(const Submessage& submessage) {
  const std::int64_t start = submessage.SequenceNumber(8);
  if (start < 1) return "a gap that begins before sequence number 1";
  if (const Problem problem = CheckNumbers(submessage, 16, 0)) return problem;
  if (submessage.SequenceNumber(16) - start > kMostGapNumbers) return "a gap of more than 1024 numbers";
  return std::nullopt;
}

Problem CheckHeartbeat(const Submessage& submessage) {
  const std::int64_t first = submessage.SequenceNumber(8);
  const std::int64_t last = submessage.SequenceNumber(16);
  if (first < 1 || last < 0) return "a heartbeat with a sequence number below its least";
  if (std::max(first - 1, last) > kLargestSequenceNumber) return kBeyondLargest;
  if (last < first - 1) return "a heartbeat that ends before it begins";
  return std::nullopt;
}

Problem CheckNackFrag(const Submessage& submessage) {
  const Problem problem = CheckSequenceNumber(submessage.SequenceNumber(8),
                                              "a request for fragments of a sequence number below 1");
  if (problem) return problem;
  if (submessage.U32(16) < 1) return "a set that begins before fragment 1";
  return CheckBitmap(submessage, 24, submessage.U32(20), 4);
}

Problem CheckSubmessage(const Submessage& submessage, const RtpsRules& rules) {
  if (submessage.body.size() < LeastBytes(submessage)) return kTooShort;
  switch (submessage.kind) {
    case kAckNack:
      return CheckAckNack(submessage);
    case kHeartbeat:
      return CheckHeartbeat(submessage);
    case kGap:
      return CheckGap(submessage);
    case kNackFrag:
      return CheckNackFrag(submessage);
    case kData:
      return CheckData(submessage);
    case kDataFrag:
      return CheckDataFrag(submessage, rules);
    default:
      return std::nullopt;
  }
}

// The endpoints of discovery and of the handshake [RTPS 2.3, table 9.13; DDS-SECURITY 1.1, section 7.4.7.1].
// An EntityId is written in the order of its bytes, whatever the order of the submessage.
enum Entity : std::uint32_t {
  kUnknownEntity = 0x00000000,
  kParticipantWriter = 0x000100c2,
  kParticipantReader = 0x000100c7,
  kHandshakeWriter = 0x000201c3,
  kHandshakeReader = 0x000201c4,
};
struct EntityPair {
  std::uint32_t writer;
  std::uint32_t reader;
};
constexpr std::array<EntityPair, 3> kPlainDiscovery = {{
    {0x000003c2, 0x000003c7},  // publications
    {0x000004c2, 0x000004c7},  // subscriptions
    {0x000200c2, 0x000200c7},  // liveliness
}};

EntityPair EntitiesOf(const Submessage& submessage) {
  const auto entity = [&](std::size_t at) {
    std::uint32_t id = 0;
    for (std::size_t k = 0; k < 4; ++k) id = id << 8U | submessage.body[at + k];
    return id;
  };
  const bool is_data = submessage.kind == kData || submessage.kind == kDataFrag;
  const std::size_t reader_at = is_data ? 4 : 0;
  return {.writer = entity(reader_at + 4), .reader = entity(reader_at)};
}

/// Whether a plain submessage is one of those that RtpsRules::secured allows. The body is as long as its kind
/// requires.
bool MayBePlain(const Submessage& submessage) {
  switch (submessage.kind) {
    case kData: {
      const auto [writer, reader] = EntitiesOf(submessage);
      return (writer == kParticipantWriter && (reader == kParticipantReader || reader == kUnknownEntity)) ||
             (writer == kHandshakeWriter && (reader == kHandshakeReader || reader == kUnknownEntity));
    }
    case kAckNack:
    case kHeartbeat: {
      const EntityPair its = EntitiesOf(submessage);
      const bool is_discovery = std::ranges::any_of(kPlainDiscovery, [&](const EntityPair& pair) {
        return pair.writer == its.writer && (pair.reader == its.reader || its.reader == kUnknownEntity);
      });
      const bool is_empty = submessage.kind == kAckNack
                                ? submessage.SequenceNumber(8) <= 1 && submessage.U32(16) == 0
                                : submessage.SequenceNumber(8) == 1 && submessage.SequenceNumber(16) == 0;
      return is_discovery && is_empty;
    }
    case kDataFrag:
    case kGap:
    case kHeartbeatFrag:
    case kNackFrag:
      return false;
    default:
      return true;
  }
}

/// Whether a Data submessage says that the participant with this prefix ends.
bool IsFarewellOf(const Submessage& submessage, Bytes prefix) {
  if (EntitiesOf(submessage).writer != kParticipantWriter) return false;
  const Bytes status = InlineQos(submessage, kStatusInfo);
  const Bytes key = InlineQos(submessage, kKeyHash);
  const bool ends = status.size() == 4 && (status[3] & 0x03U) != 0;  // disposed or unregistered
  return ends && key.size() == 16 && std::ranges::equal(key.first(kPrefixBytes), prefix);
}

/// Calls `check` with each submessage until it returns a problem. @return That problem, or what is wrong with
/// the sequence of submessages itself.
template <class Check>
Problem ForEachSubmessage(Bytes datagram, Check&& check) {
  constexpr std::array<std::uint8_t, 4> kMagic = {'R', 'T', 'P', 'S'};
  if (datagram.size() < kHeaderBytes) return "shorter than an RTPS header";
  if (!std::equal(kMagic.begin(), kMagic.end(), datagram.begin())) return "not an RTPS message";
  Bytes rest = datagram.subspan(kHeaderBytes);
  while (!rest.empty()) {
    if (rest.size() < kSubmessageHeaderBytes) return "a submessage header that ends beyond the datagram";
    Submessage submessage{static_cast<Kind>(rest[0]), rest[1], rest.subspan(2)};
    std::size_t length = submessage.U16(0);
    rest = rest.subspan(kSubmessageHeaderBytes);
    // A length of 0 extends the submessage to the end of the message, except for kinds that can be empty.
    if (length == 0 && submessage.kind != kPad && submessage.kind != kInfoTimestamp) length = rest.size();
    if (length > rest.size()) return "a submessage that ends beyond the datagram";
    const bool is_last = length == rest.size();
    if (!is_last && length % 4 != 0) return "a submessage that leaves the next one unaligned";
    if (submessage.kind == kFastDdsStatistics && !(is_last && length == kStatisticsBytes)) {
      return "statistics of Fast DDS that are not the end of the message";
    }
    submessage.body = rest.first(length);
    if (const Problem problem = check(submessage)) return problem;
    rest = rest.subspan(length);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string_view> FindRtpsError(std::span<const std::uint8_t> datagram,
                                              const RtpsRules& rules) {
  return ForEachSubmessage(datagram, [&](const Submessage& submessage) -> Problem {
    if (const Problem problem = CheckSubmessage(submessage, rules)) return problem;
    if (rules.secured && !MayBePlain(submessage)) return "not encrypted, while this bus has keys";
    return std::nullopt;
  });
}

RtpsContents ContentsOf(std::span<const std::uint8_t> datagram) {
  RtpsContents contents;
  if (datagram.size() < kHeaderBytes) return contents;
  Bytes prefix = datagram.subspan(kHeaderBytes - kPrefixBytes, kPrefixBytes);  // of the sender
  std::ranges::copy(prefix, contents.sender.begin());
  ForEachSubmessage(datagram, [&](const Submessage& submessage) -> Problem {
    if (submessage.body.size() < LeastBytes(submessage)) return kTooShort;
    if (submessage.kind == kDataFrag) contents.has_fragments = true;
    if (submessage.kind == kData) {
      const std::uint32_t writer = EntitiesOf(submessage).writer;
      if (writer == kParticipantWriter || writer == kHandshakeWriter) contents.introduces = true;
      if (!contents.farewell && IsFarewellOf(submessage, prefix)) {
        contents.farewell =
            static_cast<std::size_t>(submessage.body.data() + submessage.body.size() - datagram.data());
      }
    }
    if (submessage.kind == kInfoSource) prefix = submessage.body.subspan(8, kPrefixBytes);
    if (submessage.kind == kHeartbeat) {
      auto& heartbeat = contents.heartbeats.emplace_back();
      const auto entity = std::ranges::copy(prefix, heartbeat.writer.begin()).out;
      std::ranges::copy(submessage.body.subspan(4, 4), entity);
      heartbeat.first = submessage.SequenceNumber(8);
    }
    return std::nullopt;
  });
  return contents;
}

}  // namespace thalweg::dds
