#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

/// A run and its map, for reports, and how much of a color their pictures have.
namespace thalweg::cli::test {

inline constexpr double kVoxel = 0.1;  // [m]

inline void FillBox(OccupancyGrid& grid, const VoxelBox& box, float log_odds) {
  ForEachVoxel(box, [&](const VoxelIndex& i) { grid.Set(i, log_odds); });
}

/// A room of 6 x 4 x 2 m inside, with walls, floor and ceiling, a table top at 0.7 m and a cupboard.
inline OccupancyGrid FurnishedRoom() {
  OccupancyGrid grid(kVoxel);
  FillBox(grid, {{-1, -1, -1}, {61, 41, 21}}, 2.0F);
  FillBox(grid, {{0, 0, 0}, {60, 40, 20}}, -2.0F);
  FillBox(grid, {{20, 10, 6}, {32, 18, 7}}, 2.0F);
  FillBox(grid, {{50, 0, 0}, {60, 6, 18}}, 2.0F);
  FillBox(grid, {{29, 20, 0}, {31, 40, 20}}, 2.0F);
  return grid;
}

/// Two minutes on an ellipse in it.
inline RunRecord ARun() {
  RunRecord record;
  record.title = "A furnished room";
  record.scenario = "room";
  record.strategy = "potential";
  record.outcome = explorer::Outcome::kComplete;
  record.succeeded = true;
  record.stop_reason = "complete";
  record.stop_details = "1 m2 of frontier stayed unknown";
  record.distance = 31.25;
  record.duration = 120.0;
  record.wall = 30.0;
  record.free_volume = 44.0;
  record.occupied_volume = 4.0;
  record.true_collisions = 0;
  record.least_clearance = 0.041;
  record.agreement = 0.98123;
  record.coverage = 0.99;
  record.plans = 23;
  record.set_aside = {{"looked at twice and stayed", 3, 41}};
  record.planning = {{"field", 23, 31.0, 60.5, 71.25}};
  record.integration = {{"integration", 600, 2.0, 3.5, 9.0}};
  record.rejected = {{"mapper", "depth/points rejected", 2, "NaN"}, {"explorer", "odometry rejected", 1, ""}};
  for (int i = 0; i <= 240; ++i) {
    const double t = 0.5 * i;
    const double angle = 2.0 * std::numbers::pi * t / 120.0;
    const Eigen::Vector3d p(3.0 + 2.2 * std::cos(angle) + 0.3 * std::cos(5 * angle),
                            1.2 + 0.8 * std::sin(angle), 1.2);
    record.trajectory.push_back({Time{} + FromSeconds(t), MakeTransform(RotationFromYawPitch(angle, 0), p)});
    ProgressSample sample;
    sample.time = t;
    sample.distance = 31.25 * t / 120.0;
    sample.explored = 48.0 * (1.0 - std::exp(-t / 30.0));
    sample.coverage = 0.99 * (1.0 - std::exp(-t / 25.0));
    record.progress.push_back(sample);
  }
  return record;
}

/// Number of pixels of a picture with approximately the given color.
inline int PixelsOf(const cv::Mat& picture, const cv::Scalar& color) {
  cv::Mat hits;
  cv::inRange(picture, color - cv::Scalar::all(12), color + cv::Scalar::all(12), hits);
  return cv::countNonZero(hits);
}

}  // namespace thalweg::cli::test
