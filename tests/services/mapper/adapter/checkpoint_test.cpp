#include "services/mapper/adapter/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <utility>

#include "common/base/hash.h"
#include "common/files/write_file.h"
#include "services/mapper/core/map_patch.h"
#include "tests/services/mapper/adapter/example_map.h"
#include "tests/services/mapper/adapter/scanned_map.h"

namespace thalweg::mapper {
namespace {

using test::ExampleColors;
using test::ExampleMap;
using test::TestFolder;

TEST(Checkpoint, BringsBackLogOddsBitByBitAndColors) {
  const OccupancyMap map = ExampleMap(0.07);
  const VoxelColors colors = ExampleColors(map.grid());
  const Result<Checkpoint> back = DecodeCheckpoint(EncodeCheckpoint(map.grid(), colors));
  ASSERT_TRUE(back) << back.error();
  EXPECT_TRUE(back->grid.SameAs(map.grid()));
  EXPECT_EQ(back->grid.block_count(), map.grid().block_count());
  EXPECT_EQ(back->colors.blocks(), colors.blocks());
}

TEST(Checkpoint, OfAnEmptyMapIsEmpty) {
  const Result<Checkpoint> back = DecodeCheckpoint(EncodeCheckpoint(OccupancyGrid(0.2), {}));
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->grid.block_count(), 0u);
  EXPECT_EQ(back->grid.voxel_size(), 0.2);
}

TEST(Checkpoint, TruncatedAnywhereIsAnError) {
  OccupancyGrid grid(0.1);
  grid.Set({1, 2, 3}, 0.5F);
  const std::string bytes = EncodeCheckpoint(grid, ExampleColors(grid));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(DecodeCheckpoint(std::string_view(bytes).substr(0, length))) << length;
  }
  EXPECT_FALSE(DecodeCheckpoint(bytes + '!'));
}

TEST(Checkpoint, WithAnyBitTurnedIsAnError) {
  OccupancyGrid grid(0.1);
  grid.Set({1, 2, 3}, 0.5F);
  std::string bytes = EncodeCheckpoint(grid, {});
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const auto turn = [&] { bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << (bit % 8))); };
    turn();
    EXPECT_FALSE(DecodeCheckpoint(bytes)) << bit;
    turn();
  }
}

TEST(Checkpoint, ThatClaimsMoreThanItHasIsAnError) {
  // The size and checksum are right, but the writer was another program: 4 billion blocks, a block beyond the
  // grid, infinity.
  OccupancyGrid infinite(0.1);
  infinite.Set({0, 0, 0}, std::numeric_limits<float>::infinity());
  const Result<Checkpoint> no_number = DecodeCheckpoint(EncodeCheckpoint(infinite, {}));
  ASSERT_FALSE(no_number);
  EXPECT_THAT(no_number.error(), testing::HasSubstr("infinite"));
  OccupancyGrid beyond(0.1);
  beyond.Set({0, 40'000, 0}, 0.5F);
  const Result<Checkpoint> no_place = DecodeCheckpoint(EncodeCheckpoint(beyond, {}));
  ASSERT_FALSE(no_place);
  EXPECT_THAT(no_place.error(), testing::HasSubstr("beyond the grid"));
}

TEST(Checkpoint, MissingFileIsNoErrorAndAForeignOneIs) {
  const TestFolder folder;
  const auto none = LoadCheckpoint(folder.path() / "none");
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->has_value());
  std::ofstream(folder.path() / "foreign") << "# Octomap OcTree file\nid OcTree\n";
  std::ofstream(folder.path() / "empty");
  for (const char* name : {"foreign", "empty"}) {
    const auto loaded = LoadCheckpoint(folder.path() / name);
    ASSERT_FALSE(loaded) << name;
    EXPECT_THAT(loaded.error(), testing::HasSubstr(name));
  }
}

TEST(Checkpoint, SaysOfWhichStateOfWhichMapItIs) {
  const MapPosition position{.map = 3, .writer = 4, .number = 5};
  const Result<Checkpoint> back = DecodeCheckpoint(EncodeCheckpoint(OccupancyGrid(0.1), {}, position));
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->position, position);
}

TEST(Checkpoint, OfTheUncompressedFormatIsStillRead) {
  OccupancyGrid grid(0.1);
  grid.Set({-1, 2, 3}, 0.5F);
  VoxelColors colors;
  colors.Add({1, 2, 3}, {10, 20, 30});
  std::string content;
  const auto put = [&content](const auto& value) {
    content.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  put(0.1);
  put(std::uint32_t{1});
  grid.ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block& block) {
    put(index);
    put(block);
  });
  put(std::uint32_t{1});
  for (const auto& [index, block] : colors.blocks()) {
    put(index);
    put(block);
  }
  const std::string body = std::exchange(content, {});
  put(std::uint64_t{body.size()});
  put(HashOf(body));
  const Result<Checkpoint> back = DecodeCheckpoint("THALWEG1" + content + body);
  ASSERT_TRUE(back) << back.error();
  EXPECT_TRUE(back->grid.SameAs(grid));
  EXPECT_EQ(back->colors.blocks(), colors.blocks());
  EXPECT_EQ(back->position, MapPosition{});
}

/// A journal of some scans from an empty map, with the offsets at which it is whole.
struct ExampleJournal {
  explicit ExampleJournal(int scans) {
    bytes = EncodeHead({map.voxel_size(), kBase});
    ends.push_back(bytes.size());
    for (int k = 1; k <= scans; ++k) {
      const auto content = Encode(map.Scan());
      const auto record =
          EncodeRecord({.map = kBase.map, .writer = 2, .number = static_cast<std::uint64_t>(k)}, *content);
      bytes.insert(bytes.end(), record.begin(), record.end());
      ends.push_back(bytes.size());
    }
  }
  Checkpoint Begun() const { return {OccupancyGrid(map.voxel_size()), {}, kBase}; }

  static constexpr MapPosition kBase{.map = 9, .writer = 1, .number = 0};
  test::ScannedMap map{3, 8};
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> ends;
};

TEST(Journal, CutAtEachByteGivesTheMapAfterItsLastWholeRecord) {
  const ExampleJournal journal(4);
  for (std::size_t length = 0; length <= journal.bytes.size(); ++length) {
    std::size_t whole = 0;
    while (whole + 1 < journal.ends.size() && journal.ends[whole + 1] <= length) ++whole;
    Checkpoint map = journal.Begun();
    const JournalUse use = ApplyJournal(Bytes(journal.bytes).first(length), map);
    const bool has_head = length >= journal.ends[0];
    ASSERT_EQ(use.applied, whole) << length;
    test::ExpectSameMap(map, journal.map.StateAfter(whole));
    ASSERT_EQ(use.ends.has_value(), has_head) << length;
    ASSERT_EQ(use.problem.empty(), has_head && length == journal.ends[whole]) << use.problem;
    if (!has_head) continue;
    EXPECT_EQ(use.unused_bytes, length - journal.ends[whole]);
    EXPECT_EQ(use.ends->offsets.back(), journal.ends[whole]);
    EXPECT_EQ(use.ends->last_number(), whole);
  }
}

TEST(Journal, WithAnyByteChangedGivesTheMapBeforeThatRecord) {
  ExampleJournal journal(3);
  for (std::size_t at = 0; at < journal.bytes.size(); ++at) {
    std::size_t before = 0;
    while (before + 1 < journal.ends.size() && journal.ends[before + 1] <= at) ++before;
    journal.bytes[at] = static_cast<std::uint8_t>(journal.bytes[at] ^ (1U + at % 255U));
    Checkpoint map = journal.Begun();
    const JournalUse use = ApplyJournal(journal.bytes, map);
    ASSERT_EQ(use.applied, at < journal.ends[0] ? 0 : before) << at;
    test::ExpectSameMap(map, journal.map.StateAfter(use.applied));
    EXPECT_NE(use.problem, "");
    journal.bytes[at] = static_cast<std::uint8_t>(journal.bytes[at] ^ (1U + at % 255U));
  }
}

TEST(Journal, ARecordWithAChecksumButNoMeaningEndsIt) {
  ExampleJournal journal(2);
  const std::vector<std::uint8_t> nonsense(20, 0xAB);
  const auto record = EncodeRecord({.map = 9, .writer = 2, .number = 3}, nonsense);
  journal.bytes.insert(journal.bytes.end(), record.begin(), record.end());
  Checkpoint map = journal.Begun();
  const JournalUse use = ApplyJournal(journal.bytes, map);
  EXPECT_EQ(use.applied, 2U);
  EXPECT_THAT(use.problem, testing::HasSubstr("scan 3"));
  EXPECT_EQ(use.unused_bytes, record.size());
  test::ExpectSameMap(map, journal.map.StateAfter(2));
}

// A child process writes checkpoints in a loop and is killed in the middle of it.
TEST(Checkpoint, IsWholeWheneverTheProcessIsKilled) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "checkpoint";
  const OccupancyMap map = ExampleMap();
  const std::string bytes = EncodeCheckpoint(map.grid(), {});
  for (int round = 0; round < 12; ++round) {
    int written[2];
    ASSERT_EQ(pipe(written), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (const char done = 1;;) {
        WriteFile(file, bytes);
        if (write(written[1], &done, 1) != 1) _exit(1);
      }
    }
    char done = 0;
    for (int count = 0; count <= round % 4; ++count) ASSERT_EQ(read(written[0], &done, 1), 1);
    ASSERT_EQ(kill(child, SIGKILL), 0);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    close(written[0]);
    close(written[1]);
    const auto loaded = LoadCheckpoint(file);
    ASSERT_TRUE(loaded) << loaded.error();
    ASSERT_TRUE(loaded->has_value());
    EXPECT_TRUE((*loaded)->grid.SameAs(map.grid()));
  }
}

}  // namespace
}  // namespace thalweg::mapper
