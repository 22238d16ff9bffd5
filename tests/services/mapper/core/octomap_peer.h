#pragma once

#include <octomap/octomap.h>

#include "services/mapper/core/occupancy_map.h"
#include "services/mapper/core/scan_points.h"

namespace thalweg::test {

/// OctoMap's own map with exactly our sensor model, given the same points in W.
class OctomapPeer : public octomap::OcTree {
 public:
  explicit OctomapPeer(const mapper::OccupancyMap::Options& options) : OcTree(options.voxel_size) {
    prob_hit_log = options.log_odds_hit;
    prob_miss_log = options.log_odds_miss;
    clamping_thres_min = options.log_odds_min;
    clamping_thres_max = options.log_odds_max;
  }

  /// The measured points of a cloud, in W as our map places them.
  static octomap::Pointcloud ToWorld(const PointCloud& cloud, const RigidTransform& T_WC) {
    const Eigen::Matrix3f R_WC = T_WC.linear().cast<float>();
    const Eigen::Vector3f p_WC = T_WC.translation().cast<float>();
    octomap::Pointcloud points_W;
    points_W.reserve(cloud.points_C.size());
    for (const Eigen::Vector3f& p_C : cloud.points_C) {
      if (!p_C.allFinite()) continue;
      const Eigen::Vector3f p_W = mapper::ToWorld(R_WC, p_WC, p_C);
      points_W.push_back(p_W.x(), p_W.y(), p_W.z());
    }
    return points_W;
  }

  void Insert(const octomap::Pointcloud& points_W, const RigidTransform& T_WC, double max_range, bool lazy,
              bool discretize = true) {
    const Eigen::Vector3f p_WC = T_WC.translation().cast<float>();
    insertPointCloud(points_W, octomap::point3d(p_WC.x(), p_WC.y(), p_WC.z()), max_range, lazy, discretize);
  }

  std::optional<float> LogOddsAt(const VoxelIndex& i) const {
    const auto key = [](std::int32_t v) { return static_cast<octomap::key_type>(v + 32768); };
    const octomap::OcTreeNode* node = search(octomap::OcTreeKey(key(i.x), key(i.y), key(i.z)));
    return node ? std::optional(node->getLogOdds()) : std::nullopt;
  }

  /// Number of voxels known in either map whose log-odds are not bitwise equal in both.
  std::size_t Differences(const OccupancyGrid& grid) {
    expand();  // so that every leaf is one voxel
    std::size_t different = 0;
    std::size_t ours = 0;
    grid.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
      ++ours;
      if (LogOddsAt(i) != log_odds) ++different;
    });
    const std::size_t theirs = getNumLeafNodes();
    return different + (theirs > ours ? theirs - ours : 0);
  }
};

}  // namespace thalweg::test
