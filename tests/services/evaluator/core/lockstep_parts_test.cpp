#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/core/lockstep.h"
#include "services/evaluator/text/run_end_text.h"

// Runs whose scenario names other types of the chain's parts.

namespace thalweg::evaluator {
namespace {

TEST(LockstepParts, ARobotThatStopsToTurnExploresAll) {
  for (const std::string minimize : {"PATH", "TIME"}) {
    double duration = 0.0;
    for (const std::string type : {"PATH_FOLLOWER", "STOP_AND_TURN"}) {
      const Scene scene("tiny",
                        {"robot.attitude=LEVEL", "explorer.minimize=" + minimize, "controller.type=" + type});
      const LockstepOptions options = scene.Options("cover", 1, PoseSource::kTruth, MotionModel::kDynamic);
      mapper::OccupancyMap map(options.mapper);
      const LockstepResult result = RunLockstep(scene.world(), scene.Start(1), options, map);
      EXPECT_EQ(ToText(result.end), "complete") << minimize << ' ' << type;
      EXPECT_EQ(result.collisions, 0);
      EXPECT_GT(result.duration, duration) << "as stopping takes time";
      duration = result.duration;
    }
  }
}

TEST(LockstepParts, WhatTheFilterDropsIsNeitherMappedNorLookedFor) {
  constexpr double kFarthest = 1.5;  // [m]
  const Scene scene("tiny", {"mapper.filter.type=DISTANCE", "mapper.filter.max_distance_m=1.5"});
  const LockstepOptions options = scene.Options("closest", 1);
  EXPECT_EQ(options.explorer.sensor_range, kFarthest);
  EXPECT_EQ(options.explorer.look_range, kFarthest);
  mapper::OccupancyMap map(options.mapper);
  std::vector<Eigen::Vector3d> eyes_W;
  const LockstepResult result = RunLockstep(scene.world(), scene.Start(1), options, map, {}, nullptr, {},
                                            [&](const PointCloud&, const RigidTransform& T_WC, const auto&) {
                                              eyes_W.push_back(T_WC.translation());
                                            });
  EXPECT_EQ(ToText(result.end), "complete");
  const OccupancyGrid grid = map.Snapshot();
  std::size_t known = 0;
  grid.ForEachKnown([&](const VoxelIndex& voxel, float) {
    ++known;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& eye_W : eyes_W)
      nearest = std::min(nearest, (grid.CenterOf(voxel) - eye_W).norm());
    // A voxel is known from a point in any corner of it, and filled between two points.
    EXPECT_LE(nearest, kFarthest + 2.0 * grid.voxel_size());
  });
  EXPECT_GT(known, 1000U);
}

}  // namespace
}  // namespace thalweg::evaluator
