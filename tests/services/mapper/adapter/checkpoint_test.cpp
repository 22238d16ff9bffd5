#include "services/mapper/adapter/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "common/files/write_file.h"
#include "tests/services/mapper/adapter/example_map.h"

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
  beyond.BlockAt({0, 5000, 0});
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
