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
  const Outcome beside = Map("crop a.ot none.ot --min 50 0 0 --max 60 2 1");
  EXPECT_EQ(beside.exit_code, 1);
  EXPECT_THAT(beside.text, HasSubstr("a.ot: no known voxel of it lies in the box"));
  EXPECT_FALSE(fs::exists(folder_ / "none.ot"));
}

/// The floor of the first map as a foreign point cloud: a point in the middle of each voxel.
void WriteScan(const fs::path& file) {
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\nelement vertex 64\nproperty float x\nproperty float y\nproperty float z\n"
         "end_header\n";
  for (int k = 0; k < 64; ++k) out << 0.125 + 0.25 * (k % 8) << ' ' << 0.125 + 0.25 * (k / 8) << " 0.1\n";
}

TEST_F(MapCommand, OfAPointCloudTheVoxelSizeMakesAMap) {
  WriteScan(folder_ / "scan.ply");
  const Outcome info = Map("info scan.ply");
  EXPECT_EQ(info.exit_code, 0) << info.text;
  EXPECT_THAT(info.text, HasSubstr("scan.ply\n  format    point cloud (.ply)\n  holds     64 points"));
  const Outcome convert = Map("convert scan.ply scan.ot --voxel-size 0.25");
  EXPECT_EQ(convert.exit_code, 0) << convert.text;
  EXPECT_EQ(Load("scan.ot").grid.LogOdds({2, 3, 0}), mapper::kOccupiedOfBt);
  EXPECT_EQ(Load("scan.ot").grid.State({8, 3, 0}), VoxelState::kUnknown);
  EXPECT_EQ(Map("crop scan.ply left.ot --voxel-size 0.5 --min 0 0 0 --max 1 2 1").exit_code, 0);
  EXPECT_EQ(Load("left.ot").grid.State({1, 3, 0}), VoxelState::kOccupied);
  EXPECT_EQ(Load("left.ot").grid.State({2, 3, 0}), VoxelState::kUnknown);
  for (const char* const command :
       {"convert scan.ply none.ot", "diff scan.ply scan.ply", "merge scan.ply scan.ply -o none.ot"}) {
    const Outcome outcome = Map(command);
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_THAT(outcome.text, HasSubstr("scan.ply: states no voxel size"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "none.ot"));
}

TEST_F(MapCommand, AmongMapsAPointCloudHasTheirVoxelSize) {
  WriteScan(folder_ / "scan.ply");
  for (const char* const order : {"a.ot scan.ply", "scan.ply a.ot"}) {
    const Outcome diff = Map("diff " + std::string(order));
    EXPECT_EQ(diff.exit_code, 1) << diff.text;
    EXPECT_THAT(diff.text, HasSubstr("1.562 % of the 64 voxels known to both agree"));
    EXPECT_EQ(Map("merge " + std::string(order) + " -o both.ot").exit_code, 0);
    EXPECT_EQ(Load("both.ot").grid.LogOdds({0, 0, 0}), mapper::kOccupiedOfBt - 1.0F);
  }
}

TEST_F(MapCommand, AMapReadsItsOwnPly) {
  EXPECT_EQ(Map("convert a.ot a.ply").exit_code, 0);
  const Outcome info = Map("info a.ply");
  EXPECT_THAT(info.text, HasSubstr("occupied voxels as cubes (.ply), no free space\n"
                                   "  voxels    0.25 m, 0 free, 1 occupied"));
  EXPECT_EQ(Map("convert a.ply b.bt").exit_code, 0);
  EXPECT_EQ(Load("b.bt").grid.State({2, 3, 0}), VoxelState::kOccupied);
  EXPECT_THAT(Map("convert a.ply c.bt --voxel-size 0.1").text,
              HasSubstr("must be a multiple of the map's 0.25 m"));
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
