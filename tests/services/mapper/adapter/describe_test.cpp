#include "services/mapper/adapter/describe.h"

#include <gtest/gtest.h>

#include <utility>

namespace thalweg::mapper {
namespace {

TEST(DescribeMap, SaysWhatItHolds) {
  ColoredMap map{.grid = OccupancyGrid(0.5), .colors = {}};
  map.grid.Set({-2, 0, 5}, -1.0F);
  map.grid.Set({3, 1, 5}, 2.0F);
  map.grid.Set({3, 2, 5}, 2.0F);
  map.colors.Add({3, 2, 5}, {1, 2, 3});
  EXPECT_EQ(Describe(LoadedMap{.map = std::move(map), .format = "a \x1b[31mformat"}),
            "  format    a \uFFFD[31mformat\n"
            "  voxels    0.5 m, 1 free, 2 occupied, 1 of these colored\n"
            "  volume    0.12 m3 free, 0.25 m3 occupied\n"
            "  bounds    x -1.00 to 2.00, y 0.00 to 1.50, z 2.50 to 3.00 m\n");
}

TEST(DescribeMap, AnEmptyOneHasNoBounds) {
  EXPECT_EQ(Describe(LoadedMap{.map = {.grid = OccupancyGrid(0.1), .colors = {}}, .format = "none"}),
            "  format    none\n"
            "  voxels    0.1 m, 0 free, 0 occupied, 0 of these colored\n"
            "  volume    0.00 m3 free, 0.00 m3 occupied\n");
}

TEST(DescribePly, SaysWhatItHoldsAndThatItIsNoMapYet) {
  PlyFile ply;
  ply.points = {{-1.0, 0.0, 2.0}, {3.0, 0.5, 2.0}, {0.0, 0.0, 2.25}};
  EXPECT_EQ(Describe(ply),
            "  format    point cloud (.ply)\n"
            "  holds     3 points, 0 triangles, without colors\n"
            "  bounds    x -1.00 to 3.00, y 0.00 to 0.50, z 2.00 to 2.25 m\n"
            "  voxels    none: `thalweg map convert` with --voxel-size makes a map of it\n");
  ply.triangles = {{0, 1, 2}};
  ply.colors.resize(3);
  EXPECT_TRUE(
      Describe(ply).starts_with("  format    mesh (.ply)\n  holds     3 points, 1 triangles, colored\n"));
}

TEST(DescribeDifference, IsATableWithTheShareThatAgrees) {
  MapDifference difference;
  difference.counts = {{{0, 1, 2}, {3, 40, 5}, {6, 7, 28}}};
  EXPECT_EQ(Describe(difference),
            "voxels, by their state in the first map (rows) and the second\n"
            "               unknown        free    occupied\n"
            "unknown              -           1           2\n"
            "free                 3          40           5\n"
            "occupied             6           7          28\n"
            "85.000 % of the 80 voxels known to both agree\n");
}

TEST(DescribeDifference, MapsThatShareNoVoxelHaveNoShare) {
  MapDifference difference;
  difference.counts = {{{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}};
  EXPECT_TRUE(Describe(difference).ends_with("\nno voxel is known to both\n"));
}

}  // namespace
}  // namespace thalweg::mapper
