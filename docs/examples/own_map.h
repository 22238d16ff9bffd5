#pragma once

#include <Eigen/Core>
#include <unordered_set>
#include <utility>
#include <vector>

#include "services/mapper/core/fused_map.h"
#include "services/mapper/core/map_copy.h"

/// A map of one's own: a voxel is free once a ray has passed it, and occupied for good once a point lay in
/// it.
class OnceOccupied final : public thalweg::mapper::FusedMap {
 public:
  /// @param stored  What an earlier process, or another engine, has mapped.
  explicit OnceOccupied(thalweg::OccupancyGrid stored) : map_(std::move(stored)) {}

  std::span<const thalweg::VoxelChange> Integrate(const thalweg::PointCloud& cloud,
                                                  const thalweg::RigidTransform& T_WC) override {
    changes_.clear();
    hits_.clear();
    const Eigen::Vector3d eye_W = T_WC.translation();
    const auto is_measured = [](const Eigen::Vector3f& p_C) { return p_C.norm() < 100.0F; };  // false for NaN
    // Occupied voxels first, so that none changes twice.
    std::unordered_set<thalweg::VoxelIndex, thalweg::VoxelIndexHash> seen;
    for (std::uint32_t pixel = 0; pixel < cloud.points_C.size(); ++pixel) {
      const Eigen::Vector3f& p_C = cloud.points_C[pixel];
      if (!is_measured(p_C)) continue;
      const thalweg::VoxelIndex end = map_.IndexOf(T_WC * p_C.cast<double>());
      if (!thalweg::InIndexRange(end) || !seen.insert(end).second) continue;
      hits_.push_back({.voxel = end, .pixel = pixel});
      if (map_.State(end) != thalweg::VoxelState::kOccupied) Set(end, 1.0F);
    }
    for (const Eigen::Vector3f& p_C : cloud.points_C) {
      if (!is_measured(p_C)) continue;
      const Eigen::Vector3d ray_W = T_WC.linear() * p_C.cast<double>();
      const int steps = static_cast<int>(2.0 * ray_W.norm() / map_.voxel_size()) + 1;
      for (int step = 0; step < steps; ++step) {
        const thalweg::VoxelIndex passed = map_.IndexOf(eye_W + ray_W * step / steps);
        if (!thalweg::InIndexRange(passed)) break;
        if (map_.State(passed) == thalweg::VoxelState::kUnknown) Set(passed, -1.0F);
      }
    }
    return changes_;
  }
  std::span<const thalweg::mapper::Hit> hits() const override { return hits_; }
  bool empty() const override { return map_.block_count() == 0; }
  thalweg::OccupancyGrid Snapshot() const override { return thalweg::mapper::CopyOf(map_); }

 private:
  void Set(const thalweg::VoxelIndex& voxel, float log_odds) {
    map_.Set(voxel, log_odds);
    changes_.push_back({voxel, log_odds});
  }

  thalweg::OccupancyGrid map_;
  std::vector<thalweg::VoxelChange> changes_;
  std::vector<thalweg::mapper::Hit> hits_;
};
