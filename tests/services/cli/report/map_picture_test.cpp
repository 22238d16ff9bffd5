#include "services/cli/report/map_picture.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/services/cli/report/example_run.h"

namespace thalweg::cli {
namespace {

using test::FillBox;
using test::FurnishedRoom;
using test::kVoxel;
using test::PixelsOf;

TEST(MapFromAbove, ShowsTableTopsFloorsAndWallsButNoCeiling) {
  const MapFromAbove map = LookFromAbove(FurnishedRoom());
  ASSERT_EQ(map.kind.cols, 62);
  ASSERT_EQ(map.kind.rows, 42);
  const auto row_of = [&](int y) { return map.kind.rows - 1 - (y - map.min_y); };
  const auto kind_at = [&](int x, int y) {
    return static_cast<ColumnKind>(map.kind(row_of(y), x - map.min_x));
  };
  EXPECT_EQ(kind_at(5, 5), ColumnKind::kSurface);
  EXPECT_FLOAT_EQ(map.height(row_of(5), 5 - map.min_x), 0.0F);
  EXPECT_FLOAT_EQ(map.height(row_of(12), 25 - map.min_x), 0.7F);
  EXPECT_FLOAT_EQ(map.height(row_of(2), 55 - map.min_x), 1.8F);
  EXPECT_EQ(kind_at(-1, 10), ColumnKind::kWall);
  EXPECT_EQ(kind_at(30, 30), ColumnKind::kWall);
}

TEST(MapFromAbove, StrayVoxelsFarAwayChangeNothingButAreCounted) {
  OccupancyGrid grid = FurnishedRoom();
  const MapFromAbove without = LookFromAbove(grid);
  EXPECT_EQ(LeftOutText(without), "");
  grid.Set({4095 * 8, 4095 * 8, 0}, 2.0F);
  grid.Set({-4095 * 8, -4095 * 8, 0}, 2.0F);
  const MapFromAbove with = LookFromAbove(grid);
  EXPECT_EQ(with.columns, 62U * 42U + 2U);
  EXPECT_EQ(with.columns_left_out, 2U);
  EXPECT_EQ(with.min_x, without.min_x);
  EXPECT_EQ(with.min_y, without.min_y);
  ASSERT_EQ(with.kind.size(), without.kind.size());
  EXPECT_EQ(cv::norm(with.kind, without.kind, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(with.height, without.height, cv::NORM_INF), 0.0);
  EXPECT_EQ(LeftOutText(with), "2 of 2606 known columns are not drawn: they lie up to 3275 m outside");
  Canvas said(1060, 900);
  Canvas silent(1060, 900);
  DrawMap(said, {0, 0, 1060, 900}, with, {});
  DrawMap(silent, {0, 0, 1060, 900}, without, {});
  EXPECT_GT(cv::norm(said.Picture(), silent.Picture(), cv::NORM_INF), 0.0);
}

TEST(MapFromAbove, ShowsThePartWithThePathEvenIfAnotherOneIsLarger) {
  OccupancyGrid grid(kVoxel);
  FillBox(grid, {{0, 0, 0}, {20, 20, 1}}, 2.0F);
  FillBox(grid, {{30'000, 0, 0}, {30'100, 100, 1}}, 2.0F);
  EXPECT_EQ(LookFromAbove(grid).min_x, 30'000);
  const TimedPose pose{Time{}, MakeTransform(Eigen::Matrix3d::Identity(), {1.0, 1.0, 0.5})};
  const MapFromAbove map = LookFromAbove(grid, {pose});
  EXPECT_EQ(map.min_x, 0);
  EXPECT_EQ(map.kind.cols, 20);
  EXPECT_EQ(map.columns_left_out, 10'000U);
}

TEST(MapFromAbove, PartsThatTogetherStaySmallEnoughAreAllDrawn) {
  OccupancyGrid grid(kVoxel);
  grid.Set({0, 0, 0}, 2.0F);
  grid.Set({900, 900, 0}, 2.0F);
  const MapFromAbove map = LookFromAbove(grid);
  EXPECT_EQ(map.kind.cols, 901);
  EXPECT_EQ(map.columns_left_out, 0U);
  EXPECT_EQ(map.voxels_per_pixel, 1);
}

TEST(MapFromAbove, AVastConnectedMapIsDrawnWithSeveralColumnsAsOnePixel) {
  OccupancyGrid grid(kVoxel);
  for (int k = -32'760; k < 32'760; k += 8) {  // a diagonal through everything that can be indexed
    grid.Set({k, k, 5}, 2.0F);
    grid.Set({k, k, 9}, -2.0F);
  }
  const MapFromAbove map = LookFromAbove(grid);
  EXPECT_LE(map.kind.total(), std::size_t{kMostEdge} * kMostEdge);
  EXPECT_EQ(map.columns_left_out, 0U);
  EXPECT_EQ(map.voxels_per_pixel, 33);  // 65513 columns / 33 = 1986 pixels, of which 4 million have room
  for (int k = 0; k < map.kind.cols; ++k) {
    EXPECT_EQ(map.kind(map.kind.rows - 1 - k, k), static_cast<std::uint8_t>(ColumnKind::kSurface));
    EXPECT_FLOAT_EQ(map.height(map.kind.rows - 1 - k, k), 0.6F);
  }
}

TEST(MapFromAbove, EmptyMapIsEmpty) {
  EXPECT_TRUE(LookFromAbove(OccupancyGrid(kVoxel)).kind.empty());
}

TEST(MapPicture, AKeyOfOneHeightShowsOneColorAndNoGradient) {
  const auto deepest_blue = [](const OccupancyGrid& grid) {
    Canvas canvas(1060, 900);
    DrawMap(canvas, {0, 0, 1060, 900}, LookFromAbove(grid), {});
    return PixelsOf(canvas.Picture(), cv::Scalar(104, 96, 44));  // the color of the highest surface
  };
  OccupancyGrid floor(kVoxel);
  FillBox(floor, {{0, 0, -1}, {40, 30, 0}}, 2.0F);
  FillBox(floor, {{0, 0, 0}, {40, 30, 8}}, -2.0F);
  EXPECT_EQ(deepest_blue(floor), 0);
  EXPECT_GT(deepest_blue(FurnishedRoom()), 0);
}

}  // namespace
}  // namespace thalweg::cli
