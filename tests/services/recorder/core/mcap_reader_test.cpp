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

/// What is left where a chunk should begin: nothing was written there, or another file's bytes.
void Damage(std::vector<std::uint8_t>& file, std::uint64_t begin, std::uint64_t count, bool random) {
  std::mt19937 generator(4);
  for (std::uint64_t k = begin; k < begin + count; ++k) {
    file[k] = random ? static_cast<std::uint8_t>(generator()) : std::uint8_t{0};
  }
}

TEST_P(EveryCompression, AFileThatIsDamagedInTheMiddleAndHasNoSummaryIsReadOnBehindTheDamage) {
  const std::vector<Sample> samples = ExampleSamples(200, 60);
  const std::vector<std::uint8_t> file = Recorded(samples, Options());
  const McapReader whole = Open(file);
  const std::vector<McapReader::Chunk>& chunks = whole.chunks();
  ASSERT_GT(chunks.size(), 6U);
  for (const bool random : {false, true}) {
    // From the middle of the third chunk to that of the fourth, and the length of the sixth.
    std::vector<std::uint8_t> killed = file;
    const std::uint64_t begin = chunks[2].offset + chunks[2].length / 2;
    Damage(killed, begin, chunks[3].offset + chunks[3].length / 2 - begin, random);
    Damage(killed, chunks[5].offset + 1, 8, random);
    killed.resize(OffsetOfFirst(Op::kDataEnd, file));
    std::vector<Sample> expected;
    std::ranges::copy_if(samples, std::back_inserter(expected), [&](const Sample& sample) {
      return std::ranges::none_of(std::array{2, 3, 5}, [&](int k) {
        const McapReader::Chunk& chunk = chunks[static_cast<std::size_t>(k)];
        return sample.log_time >= chunk.start && sample.log_time <= chunk.end;
      });
    });
    ASSERT_LT(expected.size(), samples.size());
    const McapReader reader = Open(killed);
    Problems problems;
    EXPECT_EQ(SamplesIn(reader, {}, &problems), expected);
    EXPECT_THAT(problems.texts(), IsEmpty());
    EXPECT_EQ(reader.message_count(), expected.size());
    EXPECT_THAT(reader.problems().texts(),
                testing::Contains("byte " + std::to_string(chunks[5].offset) + ": " +
                                  "no whole record: " + std::to_string(chunks[6].offset - chunks[5].offset) +
                                  " bytes are left out, up to the next whole chunk"));
    EXPECT_LT(reader.whole_until(), chunks[4].offset);
    EXPECT_FALSE(reader.Check().empty());
  }
}

TEST(McapReader, ChannelsThatADamagedChunkAnnouncesStandBeforeItAsWell) {
  const std::vector<Sample> samples = ExampleSamples(100, 60);
  std::vector<std::uint8_t> file = Recorded(samples, {.compression = Compression::kNone, .chunk_bytes = 400});
  file.resize(OffsetOfFirst(Op::kDataEnd, file));  // as a killed recorder leaves it
  const McapReader::Chunk first = Open(file).chunks()[0];
  file[first.offset + first.length - 1] ^= 1;  // the last byte of a payload
  std::vector<Sample> expected;
  std::ranges::copy_if(samples, std::back_inserter(expected),
                       [&](const Sample& sample) { return sample.log_time > first.end; });
  EXPECT_EQ(SamplesIn(Open(file)), expected);
}

TEST(McapReader, ChannelsOfADamagedChunkAreTakenFromTheSummaryOrTheirMessagesAreCountedAsLost) {
  const std::vector<Sample> samples = ExampleSamples(100, 60);
  std::vector<std::uint8_t> file = Recorded(samples, {.compression = Compression::kNone, .chunk_bytes = 400});
  const McapReader::Chunk first = Open(file).chunks()[0];
  const std::uint64_t announced = OffsetOfFirst(Op::kSchema, file);  // other writers announce in chunks alone
  file.erase(file.begin() + static_cast<std::ptrdiff_t>(announced),
             file.begin() + static_cast<std::ptrdiff_t>(first.offset));
  file[announced + first.length - 1] ^= 1;  // the last byte of a payload; all schemas are in this chunk
  file.pop_back();                          // cuts the magic, without which no summary is looked for
  std::vector<Sample> expected;
  std::ranges::copy_if(samples, std::back_inserter(expected),
                       [&](const Sample& sample) { return sample.log_time > first.end; });
  const McapReader with_channels = Open(file);
  EXPECT_FALSE(with_channels.has_summary());
  EXPECT_EQ(SamplesIn(with_channels), expected);

  file.resize(OffsetOfFirst(Op::kDataEnd, file));
  const McapReader without = Open(file);
  EXPECT_THAT(SamplesIn(without), IsEmpty());
  EXPECT_FALSE(without.start());
  EXPECT_THAT(without.chunks(), IsEmpty());
  std::uint64_t lost = 0;
  for (const std::string& text : without.problems().texts()) {
    const auto at = text.find("from here on ");
    if (at != std::string::npos) lost += std::stoull(text.substr(at + std::string("from here on ").size()));
  }
  EXPECT_EQ(lost, expected.size());
}

/// Bytes that are no record, `count` chunks with wrong CRCs of which each holds all that follow, and a good
/// one.
std::vector<std::uint8_t> ChunksWithinChunks(std::uint64_t count) {
  std::vector<std::uint8_t> file = Recorded(ExampleSamples(3, 60), {.compression = Compression::kNone});
  const McapReader::Chunk good = Open(file).chunks()[0];
  const std::vector<std::uint8_t> last(file.begin() + static_cast<std::ptrdiff_t>(good.offset),
                                       file.begin() + static_cast<std::ptrdiff_t>(good.offset + good.length));
  file.resize(good.offset);
  file.resize(file.size() + 8);
  constexpr std::uint64_t kFields = 40;
  for (std::uint64_t k = 1; k <= count; ++k) {
    const std::uint64_t rest = (count - k) * (kRecordHeaderBytes + kFields) + last.size();
    ByteWriter chunk;
    chunk.U8(static_cast<std::uint8_t>(Op::kChunk));
    chunk.U64(kFields + rest);
    chunk.U64(0);
    chunk.U64(1);
    chunk.U64(rest);
    chunk.U32(1);
    chunk.String("");
    chunk.U64(rest);
    file.insert(file.end(), chunk.bytes().begin(), chunk.bytes().end());
  }
  file.insert(file.end(), last.begin(), last.end());
  return file;
}

TEST(McapReader, TheNextWholeChunkIsSoughtWithABoundedEffort) {
  const ReadLimits limits{.chunk_bytes = 1 << 20, .open_bytes = 1 << 20};
  const std::vector<std::uint8_t> few = ChunksWithinChunks(50);
  EXPECT_EQ(SamplesIn(*McapReader::Open(few, limits)).size(), 3U);
  const std::vector<std::uint8_t> many = ChunksWithinChunks(5000);  // 600 MB to decompress
  const McapReader reader = *McapReader::Open(many, limits);
  EXPECT_THAT(SamplesIn(reader), IsEmpty());
  EXPECT_THAT(reader.problems().texts(),
              testing::Contains(HasSubstr("bytes follow, to the end of the file")));
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
