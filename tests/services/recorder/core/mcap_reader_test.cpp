#include "services/recorder/core/mcap_reader.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "common/compression/compression.h"
#include "tests/services/recorder/core/example_recording.h"

namespace thalweg::recorder {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

McapReader Open(Bytes file) {
  auto reader = McapReader::Open(file);
  EXPECT_TRUE(reader) << reader.error();
  return *std::move(reader);
}

class EveryCompression : public testing::TestWithParam<Compression> {
 protected:
  McapWriter::Options Options() const { return {.compression = GetParam(), .chunk_bytes = 400}; }
};
INSTANTIATE_TEST_SUITE_P(Mcap, EveryCompression,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd));

TEST_P(EveryCompression, WhatIsWrittenIsReadBack) {
  const std::vector<Sample> samples = ExampleSamples(200, 60);
  const std::vector<std::uint8_t> file = Recorded(samples, Options());
  const McapReader reader = Open(file);
  EXPECT_TRUE(reader.has_summary());
  EXPECT_THAT(reader.problems().texts(), IsEmpty());
  EXPECT_THAT(reader.Check().texts(), IsEmpty());
  EXPECT_EQ(reader.profile(), "ros2");
  EXPECT_GT(reader.chunks().size(), 10U);
  EXPECT_EQ(reader.message_count(), samples.size());
  EXPECT_EQ(reader.start(), samples.front().log_time);
  EXPECT_EQ(reader.end(), samples.back().log_time);
  std::vector<Channel> channels;
  for (const auto& [number, channel] : reader.channels()) channels.push_back(channel);
  EXPECT_EQ(channels, ExampleChannels());
  ASSERT_EQ(reader.metadata().size(), 1U);
  EXPECT_EQ(reader.metadata()[0].pairs.at("text"), "mapper { }");
  EXPECT_EQ(SamplesIn(reader), samples);
}

TEST_P(EveryCompression, ASelectionReadsWhatALoopOverAllWouldKeep) {
  const std::vector<Sample> samples = ExampleSamples(200, 60);
  const std::vector<std::uint8_t> file = Recorded(samples, Options());
  const McapReader reader = Open(file);
  const Selection selection{.start = At(101), .end = At(300), .topics = {"pose", "/late"}};
  std::vector<Sample> expected;
  std::ranges::copy_if(samples, std::back_inserter(expected), [](const Sample& sample) {
    return sample.log_time >= At(101) && sample.log_time < At(300) && sample.topic != "/points";
  });
  ASSERT_GT(expected.size(), 20U);
  EXPECT_EQ(SamplesIn(reader, selection), expected);
}

TEST_P(EveryCompression, AFileCutAnywhereIsReadUpToItsLastWholeChunk) {
  const std::vector<Sample> samples = ExampleSamples(40, 60);
  const std::vector<std::uint8_t> file = Recorded(samples, Options());
  const McapReader whole = Open(file);
  for (std::size_t size = kMagic.size(); size < file.size(); ++size) {
    const Bytes cut = Bytes(file).first(size);
    const McapReader reader = Open(cut);
    ASSERT_FALSE(reader.has_summary());
    ASSERT_FALSE(reader.problems().empty()) << size;
    ASSERT_LE(reader.whole_until(), size);
    Problems problems;
    const std::vector<Sample> read = SamplesIn(reader, {}, &problems);
    ASSERT_THAT(problems.texts(), IsEmpty()) << size;
    // All messages of the chunks that end before the cut, and no others.
    std::size_t expected = 0;
    for (const McapReader::Chunk& chunk : whole.chunks()) {
      if (chunk.offset + chunk.length > size) break;
      expected += static_cast<std::size_t>(std::ranges::count_if(
          samples, [&](const Sample& s) { return s.log_time >= chunk.start && s.log_time <= chunk.end; }));
    }
    ASSERT_EQ(read.size(), expected) << size;
    ASSERT_TRUE(std::equal(read.begin(), read.end(), samples.begin())) << size;
  }
}

TEST_P(EveryCompression, AFlippedBitAnywhereIsNamedAndNoWrongMessageIsRead) {
  const std::vector<Sample> samples = ExampleSamples(40, 60);
  const std::vector<std::uint8_t> file = Recorded(samples, Options());
  std::mt19937 random(2);
  for (std::size_t k = 0; k < file.size(); ++k) {
    std::vector<std::uint8_t> flipped = file;
    flipped[k] ^= static_cast<std::uint8_t>(1U << (random() % 8U));
    const auto reader = McapReader::Open(flipped);
    if (!reader) {
      ASSERT_LT(k, kMagic.size());
      continue;
    }
    EXPECT_FALSE(reader->Check().empty()) << "byte " << k;
    Problems problems;
    const std::vector<Sample> read = SamplesIn(*reader, {}, &problems);
    for (const Sample& sample : read) {
      ASSERT_NE(std::ranges::find(samples, sample), samples.end()) << "byte " << k;
    }
    if (read.size() < samples.size()) {
      EXPECT_FALSE(problems.empty() && reader->problems().empty())
          << "byte " << k << " lost messages unnamed";
    }
  }
}

TEST_P(EveryCompression, RandomBytesInPlaceOfAFileDoNoHarm) {
  const std::vector<std::uint8_t> file = Recorded(ExampleSamples(40, 60), Options());
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint8_t> bytes = file;
    for (int change = 0; change < 8; ++change) {
      bytes[kMagic.size() + random() % (bytes.size() - kMagic.size())] = static_cast<std::uint8_t>(random());
    }
    const auto reader = McapReader::Open(bytes);
    ASSERT_TRUE(reader);
    SamplesIn(*reader);
    reader->Check();
  }
}

std::size_t OffsetOfFirst(Op op, Bytes file) {
  std::size_t offset = kMagic.size();
  while (file[offset] != static_cast<std::uint8_t>(op)) {
    offset += kRecordHeaderBytes + ByteReader(file.subspan(offset + 1)).U64();
  }
  return offset;
}

TEST(McapReader, NamesAWrongCrcOfAChunkAndReadsTheOthers) {
  const std::vector<Sample> samples = ExampleSamples(100, 60);
  std::vector<std::uint8_t> file = Recorded(samples, {.compression = Compression::kNone, .chunk_bytes = 400});
  const McapReader whole = Open(file);
  const McapReader::Chunk chunk = whole.chunks()[1];
  file[chunk.offset + chunk.length - 1] ^= 1;  // the last byte of a payload
  const McapReader reader = Open(file);
  Problems problems;
  const std::vector<Sample> read = SamplesIn(reader, {}, &problems);
  EXPECT_LT(read.size(), samples.size());
  EXPECT_GT(read.size(), samples.size() / 2);
  ASSERT_EQ(problems.count(), 1U);
  EXPECT_EQ(problems.texts()[0],
            "byte " + std::to_string(chunk.offset) + ": the chunk's CRC is wrong, it is left out");
}

TEST(McapReader, NamesAWrongCrcOfTheSummaryAndScansTheData) {
  const std::vector<Sample> samples = ExampleSamples(100, 60);
  std::vector<std::uint8_t> file = Recorded(samples, {.chunk_bytes = 400});
  file[file.size() - 60] ^= 1;
  const McapReader reader = Open(file);
  EXPECT_FALSE(reader.has_summary());
  ASSERT_EQ(reader.problems().count(), 1U);
  EXPECT_THAT(reader.problems().texts()[0], HasSubstr("the summary's CRC is wrong"));
  EXPECT_EQ(SamplesIn(reader), samples);
}

TEST(McapReader, RefusesAChunkThatClaimsMoreThanIsAccepted) {
  std::vector<std::uint8_t> file = Recorded(ExampleSamples(10, 60), {.chunk_bytes = 1 << 20});
  const std::size_t size_field = OffsetOfFirst(Op::kChunk, file) + kRecordHeaderBytes + 16;
  file[size_field + 6] = 1;                                            // 2^48 bytes
  const McapReader reader = Open(Bytes(file).first(file.size() - 8));  // scanned, for want of the last magic
  EXPECT_THAT(SamplesIn(reader), IsEmpty());
  EXPECT_THAT(reader.problems().texts(),
              testing::Contains(HasSubstr("more than the 268435456 that are accepted")));
}

/// A record of one byte for its kind, eight for its length, and its content.
void Append(std::vector<std::uint8_t>& file, Op op, const ByteWriter& content) {
  ByteWriter record;
  record.U8(static_cast<std::uint8_t>(op));
  record.U64(content.bytes().size());
  file.insert(file.end(), record.bytes().begin(), record.bytes().end());
  file.insert(file.end(), content.bytes().begin(), content.bytes().end());
}

TEST(McapReader, AFileWrittenWithoutASummaryIsNotDamaged) {
  const std::vector<Sample> samples = ExampleSamples(20, 60);
  std::vector<std::uint8_t> file = Recorded(samples, {.chunk_bytes = 400});
  file.resize(OffsetOfFirst(Op::kDataEnd, file));
  EXPECT_FALSE(Open(file).is_without_summary());
  ByteWriter crc, footer;
  crc.U32(0);
  footer.U64(0);
  footer.U64(0);
  footer.U32(0);
  Append(file, Op::kDataEnd, crc);
  Append(file, Op::kFooter, footer);
  file.insert(file.end(), kMagic.begin(), kMagic.end());
  const McapReader reader = Open(file);
  EXPECT_TRUE(reader.is_without_summary());
  EXPECT_THAT(reader.Check().texts(), IsEmpty());
  EXPECT_EQ(SamplesIn(reader), samples);
}

/// A file whose data are those of `file`, whole, and whose summary is `summary`.
std::vector<std::uint8_t> WithSummary(std::vector<std::uint8_t> file, Bytes summary) {
  const ByteWriter no_crc = [] {
    ByteWriter content;
    content.U32(0);
    return content;
  }();
  Append(file, Op::kDataEnd, no_crc);
  ByteWriter footer;
  footer.U64(file.size());
  footer.U64(0);
  footer.U32(0);
  file.insert(file.end(), summary.begin(), summary.end());
  Append(file, Op::kFooter, footer);
  file.insert(file.end(), kMagic.begin(), kMagic.end());
  return file;
}

TEST(McapReader, MetadataThatTheSummaryListsAgainAndAgainIsReadOnce) {
  std::vector<std::uint8_t> file = Recorded({}, {});
  const std::size_t metadata = OffsetOfFirst(Op::kMetadata, file);
  file.resize(OffsetOfFirst(Op::kDataEnd, file));
  std::vector<std::uint8_t> summary;
  for (int k = 0; k < 1000; ++k) {
    ByteWriter index;
    index.U64(metadata);
    index.U64(0);
    index.String("scenario");
    Append(summary, Op::kMetadataIndex, index);
  }
  const McapReader reader = Open(WithSummary(file, summary));
  EXPECT_EQ(reader.metadata().size(), 1U);
  EXPECT_FALSE(reader.has_summary());
  EXPECT_THAT(reader.problems().texts(), testing::Contains(HasSubstr("a record that makes no sense")));
}

TEST(McapReader, AnyNumberOfChannelsSharesNoMoreThanSoManyBytesOfSchemas) {
  std::vector<std::uint8_t> file = Recorded({}, {});
  file.resize(OffsetOfFirst(Op::kDataEnd, file));
  ByteWriter schema;
  schema.U16(1);
  schema.String("a/msg/Huge");
  schema.String("ros2msg");
  schema.String(std::string(30'000'000, '#'));
  std::vector<std::uint8_t> summary;
  Append(summary, Op::kSchema, schema);
  for (std::uint16_t k = 0; k < 500; ++k) {  // copies of 15 GB
    ByteWriter channel;
    channel.U16(k);
    channel.U16(1);
    channel.String("/topic");
    channel.String("cdr");
    channel.U32(0);
    Append(summary, Op::kChannel, channel);
  }
  const McapReader reader = Open(WithSummary(file, summary));
  EXPECT_FALSE(reader.has_summary());
  EXPECT_THAT(reader.channels(), IsEmpty()) << "as in the data";
  EXPECT_THAT(reader.problems().texts(), testing::Contains(HasSubstr("a record that makes no sense")));
}

TEST(McapReader, TheLastTimeThereIsIsRead) {
  const Sample last{"/points", 0, Time::max(), Time::max(), {1}};
  const std::vector<std::uint8_t> file = Recorded({last}, {});
  EXPECT_EQ(SamplesIn(Open(file)), std::vector{last});
  EXPECT_THAT(SamplesIn(Open(file), {.end = Time::max() - Duration(1)}), IsEmpty());
}

TEST(McapReader, AMessageWithATimeBeyondTheRangeIsLeftOutAlone) {
  const std::uint64_t beyond = std::uint64_t{1} << 63U;
  for (const bool publish_only : {false, true}) {
    ByteWriter channel;
    channel.U16(0);
    channel.U16(0);
    channel.String("/points");
    channel.String("cdr");
    channel.U32(0);
    std::vector<std::uint8_t> records;
    Append(records, Op::kChannel, channel);
    for (const std::uint64_t time : {std::uint64_t{5}, beyond, std::uint64_t{7}}) {
      ByteWriter message;
      message.U16(0);
      message.U32(static_cast<std::uint32_t>(time & 0xFFU));
      message.U64(publish_only ? 6 : time);
      message.U64(time);
      Append(records, Op::kMessage, message);
    }
    ByteWriter chunk;
    chunk.U64(5);
    chunk.U64(publish_only ? 7 : beyond);
    chunk.U64(records.size());
    chunk.U32(Crc32(records));
    chunk.String("");
    chunk.U64(records.size());
    chunk.Append(records);
    std::vector<std::uint8_t> file = Recorded({}, {});
    file.resize(OffsetOfFirst(Op::kDataEnd, file));
    Append(file, Op::kChunk, chunk);
    const McapReader reader = Open(file);
    EXPECT_EQ(reader.message_count(), 2U);
    Problems problems;
    const std::vector<Sample> read = SamplesIn(reader, {}, &problems);
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].sequence, 5U);
    EXPECT_EQ(read[1].sequence, 7U);
    EXPECT_THAT(problems.texts(), testing::ElementsAre(HasSubstr("makes no sense, left out")));
  }
}

TEST(McapReader, RefusesWhatIsNoMcapFile) {
  const std::vector<std::uint8_t> text(100, 'x');
  EXPECT_FALSE(McapReader::Open(text));
  EXPECT_FALSE(McapReader::Open({}));
}

TEST(McapReader, ChunksThatOverlapInTimeAreMerged) {
  // The second channel's messages arrive late, in another chunk.
  std::vector<Sample> samples;
  for (int k = 0; k < 50; ++k)
    samples.push_back({"/points", static_cast<std::uint32_t>(k), At(2 * k), At(0), {1}});
  for (int k = 0; k < 50; ++k)
    samples.push_back({"/pose", static_cast<std::uint32_t>(k), At(2 * k + 1), At(0), {2}});
  const std::vector<std::uint8_t> file = Recorded(samples, {.chunk_bytes = 500});
  const McapReader reader = Open(file);
  std::ranges::sort(samples, {}, &Sample::log_time);
  EXPECT_EQ(SamplesIn(reader), samples);
}

TEST(McapReader, AFileOfALiveRecorderIsReadUpToItsLastFlush) {
  std::vector<std::uint8_t> file;
  McapWriter writer({}, [&](Bytes bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  const std::uint16_t channel = writer.AddChannel(ExampleChannels()[0]);
  const std::vector<std::uint8_t> payload = {1, 2, 3};
  writer.Write(channel, 0, At(0), At(0), payload);
  writer.Flush();
  writer.Write(channel, 1, At(1), At(1), payload);  // stays in the open chunk
  const McapReader reader = Open(file);
  EXPECT_EQ(reader.whole_until(), file.size());
  EXPECT_EQ(SamplesIn(reader).size(), 1U);
}

}  // namespace
}  // namespace thalweg::recorder
