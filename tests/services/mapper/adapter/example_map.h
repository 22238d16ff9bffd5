#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>

#include "services/mapper/core/occupancy_map.h"
#include "services/mapper/core/voxel_colors.h"
#include "tests/support/analytic_room.h"

namespace thalweg::test {

/// A map of the furnished room, seen from several poses.
inline mapper::OccupancyMap ExampleMap(double voxel_size = 0.1) {
  mapper::OccupancyMap map(mapper::OccupancyMap::Options{.voxel_size = voxel_size});
  std::mt19937 random(31);
  const AnalyticRoom room = AnalyticRoom::Furnished();
  for (int scan = 0; scan < 4; ++scan) {
    const RigidTransform T_WC = room.RandomPose(random);
    map.Integrate(room.Render(PinholeCamera::FromFieldOfView(60, 45, 1.3), T_WC), T_WC);
  }
  return map;
}

/// A color for each occupied voxel that encodes its position.
inline mapper::VoxelColors ExampleColors(const OccupancyGrid& grid) {
  mapper::VoxelColors colors;
  grid.ForEachKnown([&colors](const VoxelIndex& i, float log_odds) {
    const auto byte = [](std::int32_t v) { return static_cast<std::uint8_t>(v & 255); };
    if (log_odds >= 0.0F) colors.Add(i, {byte(i.x), byte(i.y), byte(i.z)});
  });
  return colors;
}

/// A temporary folder of the test, removed by the destructor.
class TestFolder {
 public:
  TestFolder() {
    std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::ranges::replace(test, '/', '_');  // which separates a test from its parameter
    path_ = std::filesystem::temp_directory_path() / ("thalweg_" + std::to_string(getpid()) + '_' + test);
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace thalweg::test
