#include "services/mapper/adapter/map_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
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
  EXPECT_THAT(ErrorOf(folder.path() / "empty"), HasSubstr("neither a map of OctoMap"));
  EXPECT_THAT(ErrorOf(folder.path() / "mesh.ply"), HasSubstr("mesh.ply: is neither a map of OctoMap"));
  EXPECT_THAT(ErrorOf(folder.path() / "cut.map"), HasSubstr("cut.map"));
  EXPECT_THROW(SaveMapAs(Example(), folder.path() / "map.stl"), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "map.stl"));
}

}  // namespace
}  // namespace thalweg::mapper
