#pragma once

#include <memory>
#include <unordered_set>
#include <vector>

#include "services/mapper/core/fused_map.h"
#include "services/mapper/core/occupancy_map.h"

namespace octomap {
class OcTree;
}  // namespace octomap

namespace thalweg::mapper {

/// A map that octomap::OcTree keeps and fuses [Hornung et al.: OctoMap, Autonomous Robots 34(3), 2013]: each
/// cloud by insertPointCloud, which prunes as it goes. As OctoMap's tool graph2tree fuses scans, voxel by
/// voxel and bit by bit.
///
/// Among the options it uses the sensor model, the ranges, exact_rays (off = OctoMap's `discretize`) and
/// no_return; protect, fill, shadow and depth_error are rules of OccupancyMap, without effect here. That a
/// scan changes a voxel once, and as a hit if a point fell into it, is OctoMap's own rule.
///
/// Departures, both on what enters: points nearer than min_range, or beyond the 2^16 voxels per axis that a
/// key can number, are ignored; a pixel that IsNoReturn becomes a point beyond max_range on its ray.
class OctreeMap final : public FusedMap {
 public:
  /// Throws std::invalid_argument naming the bad option.
  explicit OctreeMap(const OccupancyMap::Options& options);
  /// Resumes from a map of the same voxel size.
  OctreeMap(const OccupancyMap::Options& options, const OccupancyGrid& map);
  ~OctreeMap() override;

  std::span<const VoxelChange> Integrate(const PointCloud& cloud, const RigidTransform& T_WC) override;
  std::span<const Hit> hits() const override { return hits_; }
  bool empty() const override;
  OccupancyGrid Snapshot() const override;

  /// The tree, pruned, with inner nodes up to date: for queries at any resolution.
  const octomap::OcTree& tree() const;

 private:
  class Tree;

  OccupancyMap::Options options_;
  std::unique_ptr<Tree> tree_;
  std::vector<Hit> hits_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> hit_voxels_;
};

}  // namespace thalweg::mapper
