#include "common/dds/rtps_message.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace thalweg::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Writes numbers in one byte order.
class Writer {
 public:
  explicit Writer(bool little_endian) : little_endian_(little_endian) {}
  Writer& U16(std::uint32_t value) { return Number(value, 2); }
  Writer& U32(std::uint64_t value) { return Number(value, 4); }
  Writer& SequenceNumber(std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    return U32(bits >> 32U).U32(bits & 0xffffffffU);
  }
  Writer& Zeros(std::size_t count) {
    bytes_.insert(bytes_.end(), count, 0);
    return *this;
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Writer& Number(std::uint64_t value, int size) {
    for (int k = 0; k < size; ++k) {
      const int shift = 8 * (little_endian_ ? k : size - 1 - k);
      bytes_.push_back(static_cast<std::uint8_t>(value >> static_cast<unsigned>(shift)));
    }
    return *this;
  }

  bool little_endian_;
  Bytes bytes_;
};

Bytes Header() {
  Bytes header = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
  header.resize(20, 7);  // the sender's prefix
  return header;
}

/// A submessage with its true length, or with the one that is given.
Bytes Submessage(int kind, int flags, const Bytes& body, int length = -1) {
  const bool little_endian = (flags & 1) != 0;
  Bytes bytes = {static_cast<std::uint8_t>(kind), static_cast<std::uint8_t>(flags)};
  const auto stated = length >= 0 ? static_cast<std::uint32_t>(length) : body.size();
  const Bytes size = Writer(little_endian).U16(static_cast<std::uint32_t>(stated)).bytes();
  bytes.insert(bytes.end(), size.begin(), size.end());
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Bytes Message(const std::vector<Bytes>& submessages) {
  Bytes message = Header();
  for (const Bytes& submessage : submessages) {
    message.insert(message.end(), submessage.begin(), submessage.end());
  }
  return message;
}

std::string ErrorOf(const Bytes& message, const RtpsRules& rules = {}) {
  return std::string(FindRtpsError(message, rules).value_or(""));
}
std::string ErrorOfOne(const Bytes& submessage, const RtpsRules& rules = {}) {
  return ErrorOf(Message({submessage}), rules);
}

/// One submessage of each kind, as the standard's section 9.4.5 lays it out.
std::vector<Bytes> OneOfEach(bool little_endian) {
  const int order = little_endian ? 1 : 0;
  const auto write = [&] { return Writer(little_endian); };
  return {
      Submessage(0x01, order, {}),
      Submessage(0x06, order, write().Zeros(8).SequenceNumber(5).U32(40).Zeros(8).U32(1).bytes()),
      Submessage(0x07, order, write().Zeros(8).SequenceNumber(1).SequenceNumber(0).U32(1).bytes()),
      Submessage(0x08, order, write().Zeros(8).SequenceNumber(1).SequenceNumber(4).U32(0).bytes()),
      Submessage(0x09, order, write().Zeros(8).bytes()), Submessage(0x09, order | 2, {}),
      Submessage(0x0c, order, write().Zeros(20).bytes()), Submessage(0x0e, order, write().Zeros(12).bytes()),
      Submessage(0x12, order, write().Zeros(8).SequenceNumber(3).U32(1).U32(256).Zeros(32).U32(1).bytes()),
      Submessage(0x13, order, write().Zeros(8).SequenceNumber(3).U32(7).U32(1).bytes()),
      // Data with inline QoS, of a parameter of 4 bytes and the sentinel, and a payload
      Submessage(0x15, order | 0x06,
                 write()
                     .U16(0)
                     .U16(16)
                     .Zeros(8)
                     .SequenceNumber(1)
                     .U16(0x70)
                     .U16(4)
                     .Zeros(4)
                     .U16(1)
                     .U16(0)
                     .Zeros(12)
                     .bytes()),
      // Data of neither inline QoS nor payload
      Submessage(0x15, order, write().U16(0).U16(16).Zeros(8).SequenceNumber(1).bytes()),
      // Fragments 2 and 3 of a sample of 2500 bytes in fragments of 1000
      Submessage(0x16, order,
                 write()
                     .U16(0)
                     .U16(28)
                     .Zeros(8)
                     .SequenceNumber(9)
                     .U32(2)
                     .U16(2)
                     .U16(1000)
                     .U32(2500)
                     .Zeros(1500)
                     .bytes()),
      Submessage(0x91, order, write().Zeros(8).bytes()),   // of another vendor
      Submessage(0x80, order, write().Zeros(56).bytes()),  // allowed at the end only
  };
}

TEST(RtpsMessage, EveryKindOfSubmessagePassesInBothByteOrders) {
  for (const bool little_endian : {true, false}) {
    EXPECT_EQ(ErrorOf(Message(OneOfEach(little_endian))), "");
    for (const Bytes& submessage : OneOfEach(little_endian)) {
      EXPECT_EQ(ErrorOfOne(submessage), "") << "kind " << int{submessage[0]};
    }
  }
  EXPECT_EQ(ErrorOf(Header()), "") << "a message may be empty";
}

TEST(RtpsMessage, WhatIsNoRtpsIsRefused) {
  EXPECT_EQ(ErrorOf({}), "shorter than an RTPS header");
  EXPECT_EQ(ErrorOf(Bytes(19, 'R')), "shorter than an RTPS header");
  EXPECT_EQ(ErrorOf(Bytes(100, 'R')), "not an RTPS message");
}

TEST(RtpsMessage, TheDatagramThatEndsFastDdsIsRefused) {
  // 84 bytes: statistics, and 4 bytes after them
  Bytes message = Message({Submessage(0x80, 1, Bytes(56)), Bytes(4)});
  ASSERT_EQ(message.size(), 84U);
  EXPECT_EQ(ErrorOf(message), "statistics of Fast DDS that are not the end of the message");
  message.resize(80);
  EXPECT_EQ(ErrorOf(message), "") << "as peers that gather statistics send them";
  EXPECT_EQ(ErrorOfOne(Submessage(0x80, 1, Bytes(60))),
            "statistics of Fast DDS that are not the end of the message");
  message.resize(79);
  EXPECT_EQ(ErrorOf(message), "a submessage that ends beyond the datagram");
}

TEST(RtpsMessage, EverySubmessageThatIsCutShortIsRefused) {
  for (const Bytes& submessage : OneOfEach(true)) {
    for (std::size_t size = 1; size < submessage.size(); ++size) {
      const Bytes cut(submessage.begin(), submessage.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_NE(ErrorOfOne(cut), "") << "kind " << int{submessage[0]} << " cut to " << size;
    }
  }
}

TEST(RtpsMessage, OnlyTheLastSubmessageMayEndUnaligned) {
  const Bytes odd = Submessage(0x91, 1, Bytes(3));
  EXPECT_EQ(ErrorOf(Message({odd})), "");
  EXPECT_EQ(ErrorOf(Message({odd, odd})), "a submessage that leaves the next one unaligned");
}

TEST(RtpsMessage, ALengthOfZeroExtendsToTheEnd) {
  const Bytes heartbeat = Writer(true).Zeros(8).SequenceNumber(1).SequenceNumber(3).U32(1).bytes();
  EXPECT_EQ(ErrorOfOne(Submessage(0x07, 1, heartbeat, 0)), "");
  EXPECT_EQ(ErrorOfOne(Submessage(0x07, 1, Bytes(27), 0)), "a submessage shorter than its kind");
}

TEST(RtpsMessage, NumbersOutsideTheirRangeAreRefused) {
  const auto write = [] { return Writer(true); };
  const auto data = [&](std::uint32_t to_qos, std::int64_t number, int flags, const Bytes& rest) {
    Bytes body = write().U16(0).U16(to_qos).Zeros(8).SequenceNumber(number).bytes();
    body.insert(body.end(), rest.begin(), rest.end());
    return ErrorOfOne(Submessage(0x15, 1 | flags, body));
  };
  EXPECT_EQ(data(16, 1, 4, Bytes(4)), "");
  EXPECT_EQ(data(16, 0, 4, Bytes(4)), "data with a sequence number below 1");
  EXPECT_EQ(data(16, -1, 4, Bytes(4)), "data with a sequence number below 1");
  EXPECT_EQ(data(12, 1, 4, Bytes(4)), "inline QoS that begins within the header of its submessage");
  EXPECT_EQ(data(65535, 1, 4, Bytes(4)), "inline QoS that begins beyond its submessage");
  EXPECT_EQ(data(16, 1, 4, Bytes(3)), "a payload that ends beyond its submessage");
  EXPECT_EQ(data(16, 1LL << 40, 4, Bytes(4)), "");
  EXPECT_EQ(data(16, (1LL << 40) + 1, 4, Bytes(4)), "a sequence number beyond 2^40");
  EXPECT_EQ(data(16, 1, 2, write().U16(5).U16(400).Zeros(8).bytes()),
            "inline QoS that does not end within its submessage");

  const auto acknack = [&](std::int64_t base, std::uint32_t bits) {
    return ErrorOfOne(Submessage(0x06, 1, write().Zeros(8).SequenceNumber(base).U32(bits).Zeros(36).bytes()));
  };
  EXPECT_EQ(acknack(1, 256), "");
  EXPECT_EQ(acknack(1, 257), "a set of more than 256 numbers");
  EXPECT_EQ(acknack(0, 0), "") << "by which Fast DDS asks for a first heartbeat";
  EXPECT_EQ(acknack(0, 1), "a set that begins before sequence number 1");
  EXPECT_EQ(acknack(-1, 0), "a set that begins before sequence number 1");
  const auto heartbeat = [&](std::int64_t first, std::int64_t last) {
    return ErrorOfOne(
        Submessage(0x07, 1, write().Zeros(8).SequenceNumber(first).SequenceNumber(last).U32(1).bytes()));
  };
  EXPECT_EQ(heartbeat(7, 6), "") << "of a writer whose history is empty";
  EXPECT_EQ(heartbeat(0, 6), "a heartbeat with a sequence number below its least");
  EXPECT_EQ(heartbeat(1, -1), "a heartbeat with a sequence number below its least");
  EXPECT_EQ(heartbeat(7, 5), "a heartbeat that ends before it begins");
  EXPECT_EQ(heartbeat((1LL << 40) + 1, 1LL << 40), "") << "a volatile writer";
  EXPECT_EQ(heartbeat(1, (1LL << 40) + 1), "a sequence number beyond 2^40");
}

/// Fragments of a sample, with `bytes` bytes of it.
Bytes Fragments(std::uint32_t first, std::uint32_t count, std::uint32_t size, std::uint32_t sample,
                std::size_t bytes, int flags = 0) {
  Writer body(true);
  body.U16(0).U16(28).Zeros(8).SequenceNumber(1).U32(first).U16(count).U16(size).U32(sample).Zeros(bytes);
  return Submessage(0x16, 1 | flags, body.bytes());
}

TEST(RtpsMessage, FragmentsMustHoldTheBytesThatTheyClaim) {
  EXPECT_EQ(ErrorOfOne(Fragments(1, 3, 1000, 2500, 2500)), "") << "the whole sample";
  EXPECT_EQ(ErrorOfOne(Fragments(1, 3, 1000, 2500, 2499)), "a payload that ends beyond its submessage");
  EXPECT_EQ(ErrorOfOne(Fragments(3, 1, 1000, 2500, 500)), "") << "the last fragment is shorter";
  EXPECT_EQ(ErrorOfOne(Fragments(3, 1, 1000, 2500, 499)), "a payload that ends beyond its submessage");
  EXPECT_EQ(ErrorOfOne(Fragments(2, 1, 1000, 2500, 996)), "a payload that ends beyond its submessage");
  EXPECT_EQ(ErrorOfOne(Fragments(1, 60, 65532, 60 * 65532, 4), {.largest_sample = 1U << 30}),
            "a payload that ends beyond its submessage")
      << "which ended the process";
}

TEST(RtpsMessage, FragmentsThatFastDdsCannotAssembleAreRefused) {
  const auto fragments = [](std::uint32_t first, std::uint32_t count, std::uint32_t size,
                            std::uint32_t sample, int flags = 0) {
    return ErrorOfOne(Fragments(first, count, size, sample, 2500, flags));
  };
  EXPECT_EQ(fragments(2, 3, 1000, 2500), "a fragment beyond the end of its sample");
  EXPECT_EQ(fragments(0xffffffff, 2, 1000, 2500), "a fragment beyond the end of its sample");
  EXPECT_EQ(fragments(0, 1, 1000, 2500), "a fragment without number or count");
  EXPECT_EQ(fragments(1, 0, 1000, 2500), "a fragment without number or count");
  EXPECT_EQ(fragments(1, 65, 8, 2500), "more than 64 fragments in a submessage");
  EXPECT_EQ(fragments(1, 64, 8, 2500), "");
  EXPECT_EQ(fragments(1, 1, 0, 2500), "a fragment of a size that is not 8, 12, 16...");
  EXPECT_EQ(fragments(1, 1, 4, 2500), "a fragment of a size that is not 8, 12, 16...");
  EXPECT_EQ(fragments(1, 1, 1001, 2500), "a fragment of a size that is not 8, 12, 16...");
  EXPECT_EQ(fragments(1, 1, 1000, 2500, 0x04), "a fragment of a key");
}

TEST(RtpsMessage, AFragmentOfALargerSampleThanAnyTopicHasIsRefused) {
  const RtpsRules rules{.largest_sample = 1'000'000};
  EXPECT_EQ(ErrorOfOne(Fragments(1, 1, 1000, 1'000'000, 1000), rules), "");
  EXPECT_EQ(ErrorOfOne(Fragments(1, 1, 1000, 1'000'001, 1000), rules),
            "a fragment of a larger sample than any topic here has");
}

TEST(RtpsMessage, AGapThatAReaderWouldWalkThroughForEverIsRefused) {
  const auto gap = [](std::int64_t start, std::int64_t base) {
    Writer body(true);
    body.Zeros(8).SequenceNumber(start).SequenceNumber(base).U32(0);
    return ErrorOfOne(Submessage(0x08, 1, body.bytes()));
  };
  EXPECT_EQ(gap(1, 1025), "");
  EXPECT_EQ(gap(1, 1026), "a gap of more than 1024 numbers");
  EXPECT_EQ(gap(1LL << 29, (1LL << 29) + 200), "");
  EXPECT_EQ(gap(1, 1LL << 56), "a sequence number beyond 2^40");
  EXPECT_EQ(gap(0, 5), "a gap that begins before sequence number 1");
}

TEST(RtpsMessage, FragmentsAndHeartbeatsAreFoundAmongOtherSubmessages) {
  const std::vector<Bytes> all = OneOfEach(true);
  const RtpsContents contents = ContentsOf(Message(all));
  EXPECT_TRUE(contents.has_fragments);
  ASSERT_EQ(contents.heartbeats.size(), 1U);
  EXPECT_EQ(contents.heartbeats[0].first, 1);
  EXPECT_FALSE(ContentsOf(Message({all[1], all[4]})).has_fragments);
}

TEST(RtpsMessage, AnnouncementsAndHandshakesAreDistinguishedFromOtherData) {
  const auto introduces = [](int kind, std::uint32_t writer) {
    Bytes body = Writer(true).U16(0).U16(16).bytes();
    const Bytes entities = Writer(false).U32(0).U32(writer).bytes();
    body.insert(body.end(), entities.begin(), entities.end());
    const Bytes number = Writer(true).SequenceNumber(1).bytes();
    body.insert(body.end(), number.begin(), number.end());
    return ContentsOf(Message({Submessage(0x09, 1, Bytes(8)), Submessage(kind, 1, body)})).introduces;
  };
  EXPECT_TRUE(introduces(0x15, 0x000100c2)) << "an announcement";
  EXPECT_TRUE(introduces(0x15, 0x000201c3)) << "a handshake";
  EXPECT_FALSE(introduces(0x15, 0x000003c2)) << "a publication";
  EXPECT_FALSE(introduces(0x15, 0x00000103)) << "a sample";
  EXPECT_FALSE(introduces(0x31, 0x000100c2)) << "encrypted";
}

TEST(RtpsMessage, AFarewellIsThatOfTheParticipantThatSentIt) {
  const auto message_about = [](std::uint8_t prefix, std::uint32_t writer, std::uint8_t status) {
    Bytes body = Writer(true).U16(0).U16(16).bytes();
    const auto add = [&](const Bytes& bytes) { body.insert(body.end(), bytes.begin(), bytes.end()); };
    add(Writer(false).U32(0x000100c7).U32(writer).bytes());
    add(Writer(true).SequenceNumber(5).U16(0x800f).U16(8).Zeros(8).U16(0x0070).U16(16).bytes());
    add(Bytes(12, prefix));
    add({0, 0, 1, 0xc1});
    add(Writer(true).U16(0x0071).U16(4).bytes());
    add({0, 0, 0, status});
    add(Writer(true).U16(1).U16(0).bytes());
    return Message({Submessage(0x09, 1, Bytes(8)), Submessage(0x15, 3, body), Submessage(0x09, 1, Bytes(8))});
  };
  const Bytes farewell = message_about(7, 0x000100c2, 3);
  ASSERT_EQ(FindRtpsError(farewell), std::nullopt);
  EXPECT_EQ(ContentsOf(farewell).farewell, farewell.size() - 12) << "without the submessage behind it";
  EXPECT_EQ(ContentsOf(farewell).sender, (std::array<std::uint8_t, 12>{7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7}));
  EXPECT_EQ(ContentsOf(message_about(9, 0x000100c2, 3)).farewell, std::nullopt) << "of another, passed on";
  EXPECT_EQ(ContentsOf(message_about(7, 0x000100c2, 0)).farewell, std::nullopt) << "alive";
  EXPECT_EQ(ContentsOf(message_about(7, 0x000003c2, 3)).farewell, std::nullopt) << "of a publication";
}

TEST(RtpsMessage, AHeartbeatIsOfTheParticipantThatTheMessageNames) {
  Bytes body = {0, 0, 0, 0, 0, 0, 1, 3};
  const Bytes numbers = Writer(true).SequenceNumber(500).SequenceNumber(600).U32(1).bytes();
  body.insert(body.end(), numbers.begin(), numbers.end());
  const Bytes heartbeat = Submessage(0x07, 1, body);
  const Bytes source = Submessage(0x0c, 1, Bytes(20, 9));
  const auto found = ContentsOf(Message({heartbeat, source, heartbeat})).heartbeats;
  ASSERT_EQ(found.size(), 2U);
  using Guid = std::array<std::uint8_t, 16>;
  EXPECT_EQ(found[0].writer, (Guid{7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 0, 0, 1, 3}));
  EXPECT_EQ(found[1].writer, (Guid{9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 0, 0, 1, 3}));
  EXPECT_EQ(found[1].first, 500);
}

TEST(RtpsMessage, WhatPrecedesASubmessageThatIsTooShortIsFound) {
  Bytes body(8);
  const Bytes numbers = Writer(true).SequenceNumber(500).SequenceNumber(600).U32(1).bytes();
  body.insert(body.end(), numbers.begin(), numbers.end());
  const Bytes heartbeat = Submessage(0x07, 1, body);
  for (const int kind : {0x07, 0x0c, 0x15}) {
    const Bytes message = Message({heartbeat, Submessage(kind, 1, Bytes(4)), heartbeat});
    EXPECT_NE(FindRtpsError(message), std::nullopt);
    EXPECT_EQ(ContentsOf(message).heartbeats.size(), 1U) << kind;
  }
}

/// What a secured bus says of a plain submessage between two entities, each given by its four bytes.
std::string SecuredErrorOf(int kind, std::uint32_t writer, std::uint32_t reader, std::int64_t first = 1,
                           std::int64_t last = 0) {
  Writer ids(false);  // an entity's bytes keep their order
  ids.U32(reader).U32(writer);
  Bytes body =
      kind == 0x15 || kind == 0x16 ? Writer(true).U16(0).U16(kind == 0x15 ? 16 : 28).bytes() : Bytes();
  body.insert(body.end(), ids.bytes().begin(), ids.bytes().end());
  Writer rest(true);
  switch (kind) {
    case 0x06:
      rest.SequenceNumber(first).U32(0).U32(1);
      break;
    case 0x07:
      rest.SequenceNumber(first).SequenceNumber(last).U32(1);
      break;
    case 0x08:
      rest.SequenceNumber(1).SequenceNumber(2).U32(0);
      break;
    case 0x12:
      rest.SequenceNumber(1).U32(1).U32(0).U32(1);
      break;
    case 0x13:
      rest.SequenceNumber(1).U32(1).U32(1);
      break;
    case 0x16:
      rest.SequenceNumber(1).U32(1).U16(1).U16(8).U32(8).Zeros(8);
      break;
    default:
      rest.SequenceNumber(1);
  }
  body.insert(body.end(), rest.bytes().begin(), rest.bytes().end());
  EXPECT_EQ(ErrorOfOne(Submessage(kind, 1, body)), "") << "well formed, without keys";
  return ErrorOfOne(Submessage(kind, 1, body), {.secured = true});
}

TEST(RtpsMessage, WithKeysNothingPlainReachesAReaderOrWriter) {
  const std::string refused = "not encrypted, while this bus has keys";
  // A user's writer, the secure and the plain writer of publications, and that of participants
  for (const std::uint32_t writer : {0x00000103U, 0xff0003c2U, 0x000003c2U, 0x000100c2U}) {
    for (const std::uint32_t reader : {0U, 0x00000204U, 0xff0003c7U, 0x000003c7U}) {
      for (const int kind : {0x08, 0x12, 0x13, 0x16}) {
        EXPECT_EQ(SecuredErrorOf(kind, writer, reader), refused) << kind << ' ' << writer << ' ' << reader;
      }
      const bool is_announcement = writer == 0x000100c2U && reader == 0;
      EXPECT_EQ(SecuredErrorOf(0x15, writer, reader), is_announcement ? "" : refused) << writer;
      const bool is_plain_discovery = writer == 0x000003c2U && (reader == 0x000003c7U || reader == 0);
      for (const int kind : {0x06, 0x07}) {
        EXPECT_EQ(SecuredErrorOf(kind, writer, reader), is_plain_discovery ? "" : refused) << writer;
      }
    }
  }
}

TEST(RtpsMessage, WithKeysPeersCanStillMeet) {
  EXPECT_EQ(SecuredErrorOf(0x15, 0x000100c2, 0x000100c7), "") << "the announcement of a participant";
  EXPECT_EQ(SecuredErrorOf(0x15, 0x000201c3, 0x000201c4), "") << "the handshake";
  EXPECT_EQ(SecuredErrorOf(0x06, 0x000004c2, 0x000004c7, 0), "") << "a greeting";
  const std::string refused = "not encrypted, while this bus has keys";
  EXPECT_EQ(SecuredErrorOf(0x07, 0x000004c2, 0x000004c7, 1, 1), refused) << "a writer that has something";
  EXPECT_EQ(SecuredErrorOf(0x06, 0x000004c2, 0x000004c7, 2), refused);
  const Bytes encrypted = Submessage(0x31, 1, Bytes(20));
  EXPECT_EQ(ErrorOfOne(encrypted, {.secured = true}), "");
}

TEST(RtpsMessage, AnyBytesAreReadWithinTheirBounds) {
  std::mt19937 random(1);
  const Bytes whole = Message(OneOfEach(true));
  for (int k = 0; k < 20'000; ++k) {
    Bytes message = whole;
    message.resize(20 + random() % (whole.size() - 20));
    message.shrink_to_fit();  // so that AddressSanitizer sees a read beyond the end
    for (unsigned flips = random() % 8; flips > 0; --flips) {
      message[random() % message.size()] = static_cast<std::uint8_t>(random());
    }
    FindRtpsError(message);
  }
}

}  // namespace
}  // namespace thalweg::dds
