#include "services/mapper/adapter/map_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <stdexcept>

#include "tests/services/mapper/adapter/example_map.h"

namespace thalweg::mapper {
namespace {

using test::ExampleColors;
using test::ExampleMap;
using test::TestFolder;
using testing::HasSubstr;

ColoredMap Example() {
  const OccupancyMap map = ExampleMap();
  ColoredMap example{.grid = OccupancyGrid(map.grid().voxel_size()), .colors = ExampleColors(map.grid())};
  map.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) { example.grid.Set(i, log_odds); });
  return example;
}

/// Expects exactly the occupied voxels of a map, with their colors.
void ExpectOccupiedOf(const ColoredMap& expected, const ColoredMap& map) {
  std::size_t occupied = 0;
  expected.grid.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    if (OccupancyGrid::StateOf(log_odds) != VoxelState::kOccupied) return;
    ASSERT_EQ(map.grid.LogOdds(i), kOccupiedOfBt) << i.x << ' ' << i.y << ' ' << i.z;
    ASSERT_EQ(map.colors.At(i), expected.colors.At(i)) << i.x << ' ' << i.y << ' ' << i.z;
    ++occupied;
  });
  std::size_t back = 0;
  map.grid.ForEachKnown([&](const VoxelIndex&, float) { ++back; });
  EXPECT_EQ(back, occupied);
  EXPECT_EQ(map.grid.voxel_size(), expected.grid.voxel_size());
}

std::string ErrorOf(const std::filesystem::path& file) {
  try {
    LoadMap(file);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(MapFormats, LogOddsComeBackBitByBitFromOtAndCheckpoint) {
  const TestFolder folder;
  const ColoredMap map = Example();
  for (const char* name : {"a.ot", "a.map"}) {
    SaveMapAs(map, folder.path() / name);
    EXPECT_TRUE(LoadMap(folder.path() / name).map.grid.SameAs(map.grid)) << name;
  }
  const LoadedMap checkpoint = LoadMap(folder.path() / "a.map");
  std::size_t colored = 0;
  map.grid.ForEachKnown([&](const VoxelIndex& i, float) {
    EXPECT_EQ(checkpoint.map.colors.At(i), map.colors.At(i));
    colored += map.colors.At(i) ? 1 : 0;
  });
  EXPECT_GT(colored, 100U);
}

TEST(MapFormats, StatesComeBackFromBt) {
  const TestFolder folder;
  const ColoredMap map = Example();
  SaveMapAs(map, folder.path() / "a.bt");
  const LoadedMap loaded = LoadMap(folder.path() / "a.bt");
  std::size_t known = 0;
  std::size_t back = 0;
  map.grid.ForEachKnown([&](const VoxelIndex& i, float) {
    EXPECT_EQ(loaded.map.grid.State(i), map.grid.State(i));
    ++known;
  });
  loaded.map.grid.ForEachKnown([&](const VoxelIndex&, float) { ++back; });
  EXPECT_EQ(back, known);
}

TEST(MapFormats, OccupiedVoxelsComeBackFromPlyToTheLastOneWithTheirColors) {
  const TestFolder folder;
  ColoredMap map = Example();
  for (const char* name : {"colored.ply", "gray.ply"}) {
    SaveMapAs(map, folder.path() / name);
    const LoadedMap loaded = LoadMap(folder.path() / name);
    ExpectOccupiedOf(map, loaded.map);
    EXPECT_THAT(loaded.format, HasSubstr("no free space"));
    map.colors = {};
  }
}

TEST(MapFormats, VoxelsWithinAndAtTheEndsOfTheGridComeBackFromPly) {
  const TestFolder folder;
  std::mt19937 random(6);
  for (const double voxel_size : {0.05, 1.0 / 3.0, 1e-3, 700.0}) {
    ColoredMap map{.grid = OccupancyGrid(voxel_size), .colors = {}};
    const auto occupy = [&](const VoxelIndex& i) {
      map.grid.Set(i, 1.0F);
      const auto byte = [&] { return static_cast<std::uint8_t>(random() % 160); };
      if (random() % 4 != 0) map.colors.Add(i, {byte(), byte(), byte()});
    };
    for (const std::int32_t corner : {-kMaxVoxelIndex - 1, -3, kMaxVoxelIndex - 5}) {
      for (std::int32_t k = 0; k < 6 * 6 * 6; ++k) {
        occupy({corner + k % 6, corner + k / 6 % 6, corner + k / 36});
      }
    }
    for (int k = 0; k < 300; ++k) {
      const auto index = [&] { return static_cast<std::int32_t>(random() % 40) + 100; };
      occupy({index(), index(), index() / 4});
    }
    SaveMapAs(map, folder.path() / "map.ply");
    ExpectOccupiedOf(map, LoadMap(folder.path() / "map.ply").map);
  }
}

TEST(MapFormats, AnEmptyMapComesBackFromPly) {
  const TestFolder folder;
  SaveMapAs({.grid = OccupancyGrid(0.2), .colors = {}}, folder.path() / "map.ply");
  const ColoredMap map = LoadMap(folder.path() / "map.ply", 0.1).map;
  EXPECT_EQ(map.grid.voxel_size(), 0.2);
  EXPECT_EQ(map.grid.block_count(), 0U);
}

TEST(MapFormats, APointCloudIsAMapOnlyWithAVoxelSize) {
  const TestFolder folder;
  const auto file = folder.path() / "scan.ply";
  std::ofstream(file) << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                         "property float z\nend_header\n-0.1 0 0\n4000 0 0\n";
  EXPECT_EQ(std::get<PlyFile>(LoadMapOrShape(file)).points.size(), 2U);
  EXPECT_THAT(ErrorOf(file), HasSubstr("scan.ply: states no voxel size"));
  EXPECT_EQ(LoadMap(file, 0.5).map.grid.LogOdds({-1, 0, 0}), kOccupiedOfBt);
  EXPECT_EQ(LoadMap(file, 0.5).format, "point cloud (.ply), no free space");
  try {
    LoadMap(file, 0.1);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("scan.ply: has a point at 4000 0 0 m, beyond 3276.8 m"));
  }
}

TEST(MapFormats, WhatAFileHoldsCountsRatherThanItsName) {
  const TestFolder folder;
  SaveMapAs(Example(), folder.path() / "a.ot");
  std::filesystem::rename(folder.path() / "a.ot", folder.path() / "map");
  EXPECT_THAT(LoadMap(folder.path() / "map").format, HasSubstr(".ot"));
}

TEST(MapFormats, WhatIsNoMapIsNamed) {
  const TestFolder folder;
  std::ofstream(folder.path() / "empty");
  std::ofstream(folder.path() / "cut.map") << "THALWEG2";
  std::ofstream(folder.path() / "mesh.ply") << "ply\n";
  EXPECT_THAT(ErrorOf(folder.path() / "none"), HasSubstr("none: cannot be read"));
  EXPECT_THAT(ErrorOf(folder.path()), HasSubstr("is a folder"));
  EXPECT_THAT(ErrorOf(folder.path() / "empty"), HasSubstr("is no map of OctoMap"));
  EXPECT_THAT(ErrorOf(folder.path() / "mesh.ply"), HasSubstr("mesh.ply: ends before its line"));
  EXPECT_THAT(ErrorOf(folder.path() / "cut.map"), HasSubstr("cut.map"));
  EXPECT_THROW(SaveMapAs(Example(), folder.path() / "map.stl"), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "map.stl"));
}

}  // namespace
}  // namespace thalweg::mapper
