#pragma once

#include "services/explorer/core/explorer.h"
#include "tests/services/explorer/support/random_planning_map.h"

/// Rooms as the mapper would report them, and explorers suited to them.
namespace thalweg::explorer::test {

inline constexpr VoxelBox kLongRoom{{0, 0, 0}, {60, 12, 12}};

/// Free within `box`, occupied all around.
inline std::vector<VoxelChange> ClosedRoom(const VoxelBox& box) {
  const VoxelIndex one{1, 1, 1};
  std::vector<VoxelChange> changes;
  ForEachVoxel({box.min - one, box.max + one}, [&](const VoxelIndex& i) {
    changes.push_back({i, box.Contains(i) ? kFreeLogOdds : kOccupiedLogOdds});
  });
  return changes;
}

/// A room whose wall at the far end, in x, has not been seen yet.
inline std::vector<VoxelChange> LongRoom(const VoxelBox& box = kLongRoom) {
  std::vector<VoxelChange> changes = ClosedRoom(box);
  std::erase_if(changes, [&](const VoxelChange& change) { return change.voxel.x == box.max.x; });
  return changes;
}

/// The long room with unknown space across it, 0.4 m thick from `x` [voxels] on.
inline std::vector<VoxelChange> RoomWithABar(int x) {
  std::vector<VoxelChange> changes = LongRoom();
  const VoxelBox bar{{x, 0, 0}, {x + 4, 12, 12}};
  std::erase_if(changes, [&](const VoxelChange& change) { return bar.Contains(change.voxel); });
  return changes;
}

/// The wall at the far end.
inline std::vector<VoxelChange> FarWall() {
  return BoxOf({{60, -1, -1}, {61, 13, 13}}, VoxelState::kOccupied);
}

inline RigidTransform At(double x, double y, double z) {
  return MakeTransform(Eigen::Matrix3d::Identity(), {x, y, z});
}

/// Where and when explorers begin: at the near end of the long room.
inline const RigidTransform kHere = At(0.55, 0.65, 0.65);
inline constexpr Time kStart{std::chrono::seconds(1000)};

/// The outcome with which a plan ends the exploration, if it does.
inline std::optional<Outcome> EndOf(const Plan& plan) {
  return plan.ending ? std::optional(plan.ending->outcome) : std::nullopt;
}

/// Options of an explorer that sets out at once, without looking around, and goes near to what it wants to
/// see.
inline Explorer::Options GoingOptions() {
  Explorer::Options options;
  options.strategy = Configure("closest");
  options.look_range = 1.0;
  options.sensor_range = 1.0;
  options.look_around_min_area = 1e4;
  return options;
}

/// A search that keeps the smallest frontiers, for what test::Knowing knows.
inline CandidateSearch::Options SearchingOptions() {
  return {.frontier = {.min_area = 0.0, .extent = 0.8},
          .robot_radius = 0.1,
          .exemption = 0.3,
          .wide_exemption = 0.6,
          .look_range = 2.0,
          .voxel_size = 0.1};
}

/// An occupied voxel at a point.
inline std::vector<VoxelChange> ObstacleAt(const Eigen::Vector3d& p_W) {
  const VoxelIndex i = VoxelAt(p_W, 0.1);
  return BoxOf({i, i + VoxelIndex{1, 1, 1}}, VoxelState::kOccupied);
}

/// The point at a given share of a path's length.
inline Eigen::Vector3d PointAlong(const std::vector<RigidTransform>& T_WBs, double share) {
  std::vector<Eigen::Vector3d> path_W;
  for (const RigidTransform& T_WB : T_WBs) path_W.push_back(T_WB.translation());
  double left = share * PathLength(path_W);
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    const double length = (path_W[n] - path_W[n - 1]).norm();
    if (length >= left && length > 0.0) return path_W[n - 1] + left / length * (path_W[n] - path_W[n - 1]);
    left -= length;
  }
  return path_W.back();
}

}  // namespace thalweg::explorer::test
