// `thalweg map` as typed by a user.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "services/mapper/adapter/map_formats.h"
#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using mapper::ColoredMap;
using test::Outcome;
using testing::HasSubstr;

/// Two maps of a floor of 8 x 8 voxels of 0.25 m with one obstacle, which stands elsewhere in the second.
class MapCommand : public testing::Test {
 protected:
  MapCommand() {
    fs::create_directories(folder_);
    mapper::SaveMapAs(Floor(2), folder_ / "a.ot");
    mapper::SaveMapAs(Floor(5), folder_ / "b.ot");
  }
  ~MapCommand() override { fs::remove_all(folder_); }

  static ColoredMap Floor(std::int32_t obstacle) {
    ColoredMap map{.grid = OccupancyGrid(0.25), .colors = {}};
    for (std::int32_t y = 0; y < 8; ++y) {
      for (std::int32_t x = 0; x < 8; ++x) map.grid.Set({x, y, 0}, x == obstacle && y == 3 ? 2.0F : -1.0F);
    }
    return map;
  }
  Outcome Map(const std::string& arguments) const {
    return test::OutcomeOf("cd '" + folder_.string() + "' && " + test::BinFolder() + "/thalweg map " +
                           arguments);
  }
  ColoredMap Load(const std::string& name) const { return mapper::LoadMap(folder_ / name).map; }

  fs::path folder_ = fs::temp_directory_path() / ("thalweg_map_" + std::to_string(getpid()));
};

TEST_F(MapCommand, InfoSaysWhatAMapHolds) {
  const Outcome outcome = Map("info a.ot b.ot");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("a.ot\n  format    OctoMap, log-odds (.ot)\n"
                                      "  voxels    0.25 m, 63 free, 1 occupied, 0 of these colored\n"
                                      "  volume    0.98 m3 free, 0.02 m3 occupied\n"
                                      "  bounds    x 0.00 to 2.00, y 0.00 to 2.00, z 0.00 to 0.25 m\nb.ot"));
}

TEST_F(MapCommand, DiffEndsWithOneWhereMapsDiffer) {
  const Outcome differing = Map("diff a.ot b.ot -o changes.ply");
  EXPECT_EQ(differing.exit_code, 1) << differing.text;
  EXPECT_THAT(differing.text, HasSubstr("96.875 % of the 64 voxels known to both agree"));
  EXPECT_TRUE(fs::exists(folder_ / "changes.ply"));
  EXPECT_EQ(Map("diff a.ot a.ot").exit_code, 0);
}

TEST_F(MapCommand, ConvertKeepsEveryVoxelAndMayCoarsen) {
  EXPECT_EQ(Map("convert a.ot a.map").exit_code, 0);
  EXPECT_TRUE(Load("a.map").grid.SameAs(Floor(2).grid));
  EXPECT_EQ(Map("convert a.ot coarse.ot --voxel-size 0.5").exit_code, 0);
  EXPECT_EQ(Load("coarse.ot").grid.State({1, 1, 0}), VoxelState::kOccupied);
  EXPECT_EQ(Load("coarse.ot").grid.State({2, 1, 0}), VoxelState::kFree);
  const Outcome odd = Map("convert a.ot odd.ot --voxel-size 0.4");
  EXPECT_EQ(odd.exit_code, 1);
  EXPECT_THAT(odd.text, HasSubstr("--voxel-size must be a multiple of the map's 0.25 m"));
}

TEST_F(MapCommand, CropAndMergeAreInverse) {
  EXPECT_EQ(Map("crop a.ot left.ot --min 0 0 0 --max 1 2 1").exit_code, 0);
  EXPECT_EQ(Map("crop a.ot right.ot --min 1 0 0 --max 2 2 1").exit_code, 0);
  EXPECT_EQ(Map("merge left.ot right.ot -o both.ot").exit_code, 0);
  EXPECT_TRUE(Load("both.ot").grid.SameAs(Floor(2).grid));
  EXPECT_EQ(Map("crop a.ot none.ot --min 1 0 0 --max 0 2 1").exit_code, 1);
}

TEST_F(MapCommand, WhatItCannotReadOrWriteIsNamedAndNothingIsWritten) {
  std::ofstream(folder_ / "cut.bt") << "# Octomap OcTree binary file\nid OcTree\nsize 3\nres 0.1\ndata\n1";
  const Outcome cut = Map("convert cut.bt out.ot");
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.text, HasSubstr("cut.bt: is cut off, at byte"));
  EXPECT_THAT(Map("info none.ot").text, HasSubstr("none.ot: cannot be read"));
  EXPECT_THAT(Map("convert a.ot a.stl").text, HasSubstr("a.stl: a map is written as .ot, .bt, .ply or .map"));
  mapper::SaveMapAs({.grid = OccupancyGrid(0.1), .colors = {}}, folder_ / "fine.ot");
  EXPECT_THAT(Map("merge a.ot fine.ot -o out.ot").text,
              HasSubstr("fine.ot: the maps' voxels have different sizes, 0.25 and 0.1 m"));
  EXPECT_FALSE(fs::exists(folder_ / "out.ot"));
}

}  // namespace
}  // namespace thalweg::cli
