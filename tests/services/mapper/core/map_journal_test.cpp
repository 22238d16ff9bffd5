#include "services/mapper/core/map_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace thalweg::mapper {
namespace {

using testing::HasSubstr;
using Buffer = std::vector<std::uint8_t>;

constexpr JournalHead kJournalHead{.voxel_size = 0.1, .base = {.map = 77, .writer = 5, .number = 40}};

Buffer Content(std::uint64_t number) {
  return Buffer(number % 7, static_cast<std::uint8_t>(number));
}

Buffer Record(std::uint64_t number, std::uint64_t map = 77) {
  return EncodeRecord({.map = map, .writer = 6, .number = number}, Content(number));
}

Buffer Joined(const std::vector<Buffer>& parts) {
  Buffer all;
  for (const Buffer& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

TEST(MapJournal, GivesBackItsRecordsInOrder) {
  const Buffer journal = Joined({EncodeHead(kJournalHead), Record(41), Record(42), Record(43)});
  Result<JournalReader> reader = JournalReader::Open(journal);
  ASSERT_TRUE(reader) << reader.error();
  EXPECT_EQ(reader->head().voxel_size, 0.1);
  EXPECT_EQ(reader->head().base, kJournalHead.base);
  for (const std::uint64_t number : {41U, 42U, 43U}) {
    const auto record = reader->Next();
    ASSERT_TRUE(record);
    EXPECT_EQ(record->position, (MapPosition{.map = 77, .writer = 6, .number = number}));
    EXPECT_EQ(Buffer(record->content.begin(), record->content.end()), Content(number));
  }
  EXPECT_FALSE(reader->Next());
  EXPECT_EQ(reader->problem(), "");
  EXPECT_EQ(reader->whole_until(), journal.size());
}

TEST(MapJournal, CutAnywhereEndsWithItsLastWholeRecord) {
  const std::vector<Buffer> parts = {EncodeHead(kJournalHead), Record(41), Record(42), Record(43)};
  const Buffer journal = Joined(parts);
  for (std::size_t length = 0; length <= journal.size(); ++length) {
    Result<JournalReader> reader = JournalReader::Open(Bytes(journal).first(length));
    ASSERT_EQ(static_cast<bool>(reader), length >= parts[0].size()) << length;
    if (!reader) continue;
    std::size_t whole = parts[0].size();
    for (std::size_t k = 1; k < parts.size() && whole + parts[k].size() <= length; ++k) {
      EXPECT_TRUE(reader->Next()) << length;
      whole += parts[k].size();
    }
    EXPECT_FALSE(reader->Next());
    EXPECT_EQ(reader->whole_until(), whole);
    EXPECT_EQ(reader->problem().empty(), whole == length) << reader->problem();
  }
}

TEST(MapJournal, WithAnyBitTurnedEndsBeforeThatRecord) {
  const std::vector<Buffer> parts = {EncodeHead(kJournalHead), Record(41), Record(42)};
  Buffer journal = Joined(parts);
  for (std::size_t bit = 0; bit < 8 * journal.size(); ++bit) {
    const auto turn = [&] {
      journal[bit / 8] = static_cast<std::uint8_t>(journal[bit / 8] ^ (1U << (bit % 8)));
    };
    turn();
    Result<JournalReader> reader = JournalReader::Open(journal);
    const bool in_head = bit / 8 < parts[0].size();
    ASSERT_EQ(static_cast<bool>(reader), !in_head) << bit;
    if (reader) {
      const bool in_first = bit / 8 < parts[0].size() + parts[1].size();
      EXPECT_EQ(reader->Next().has_value(), !in_first) << bit;
      EXPECT_FALSE(reader->Next()) << bit;
      EXPECT_NE(reader->problem(), "") << bit;
    }
    turn();
  }
}

TEST(MapJournal, RecordsOutOfOrderOrOfAnotherMapAreNotRead) {
  for (const Buffer& second : {Record(41), Record(43), Record(40), Record(42, 78)}) {
    const Buffer journal = Joined({EncodeHead(kJournalHead), Record(41), second});
    Result<JournalReader> reader = JournalReader::Open(journal);
    ASSERT_TRUE(reader);
    EXPECT_TRUE(reader->Next());
    EXPECT_FALSE(reader->Next());
    EXPECT_THAT(reader->problem(), HasSubstr("the record after scan 41 is"));
    EXPECT_EQ(reader->whole_until(), kJournalHeadBytes + Record(41).size());
  }
}

TEST(MapJournal, HeadsThatLieAreRefused) {
  EXPECT_THAT(JournalReader::Open({}).error(), HasSubstr("is not a journal"));
  for (const double size :
       {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    const Buffer head = EncodeHead({.voxel_size = size, .base = {}});
    EXPECT_THAT(JournalReader::Open(head).error(), HasSubstr("voxel size"));
  }
}

}  // namespace
}  // namespace thalweg::mapper
