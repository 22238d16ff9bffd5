#include "services/mapper/core/octree_map.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "common/base/require.h"
#include "common/base/text.h"
#include "common/voxel/for_each_voxel.h"
#include "services/mapper/core/octomap_keys.h"
#include "services/mapper/core/scan_marks.h"
#include "services/mapper/core/scan_points.h"

namespace thalweg::mapper {
namespace {

octomap::point3d PointFrom(const Eigen::Vector3f& p) {
  return {p.x(), p.y(), p.z()};
}

/// Adds a point beyond the range on the ray of each pixel without a return.
void AddNoReturns(const PointCloud& cloud, const PinholeCamera& camera, double max_range,
                  const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC, octomap::Pointcloud& points_W) {
  const auto pixels = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  if (cloud.width_px != camera.width_px || cloud.height_px != camera.height_px) return;
  if (cloud.points_C.size() != pixels) return;
  const auto beyond = static_cast<float>(2.0 * max_range);
  std::size_t pixel = 0;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u, ++pixel) {
      if (!IsNoReturn(cloud.points_C[pixel])) continue;
      const Eigen::Vector3f direction_C = camera.RayAtUnitDepth(u, v).normalized().cast<float>();
      points_W.push_back(PointFrom(ToWorld(R_WC, p_WC, direction_C * beyond)));
    }
  }
}

}  // namespace

/// OctoMap's tree, which notes what changes. Its own change detection (enableChangeDetection) names the
/// voxels that are new or changed between free and occupied; the readers of our map want all whose log-odds
/// changed. insertPointCloud passes each of its updates through updateNode.
class OctreeMap::Tree final : public octomap::OcTree {
 public:
  explicit Tree(const OccupancyMap::Options& options) : OcTree(options.voxel_size) {
    prob_hit_log = options.log_odds_hit;
    prob_miss_log = options.log_odds_miss;
    clamping_thres_min = options.log_odds_min;
    clamping_thres_max = options.log_odds_max;
  }

  /// Takes over the values of a map as they are, without clamping them.
  void Restore(const OccupancyGrid& map) {
    const auto limits = std::pair(clamping_thres_min, clamping_thres_max);
    clamping_thres_min = std::numeric_limits<float>::lowest();
    clamping_thres_max = std::numeric_limits<float>::max();
    map.ForEachKnown([this](const VoxelIndex& i, float log_odds) {
      setNodeValue(KeyOf(i), log_odds, /*lazy_eval=*/true);
    });
    updateInnerOccupancy();
    prune();
    std::tie(clamping_thres_min, clamping_thres_max) = limits;
  }

  using OcTree::updateNode;
  octomap::OcTreeNode* updateNode(const octomap::OcTreeKey& key, float log_odds_update,
                                  bool lazy_eval) override {
    const octomap::OcTreeNode* const leaf = search(key);
    const float before = leaf != nullptr ? leaf->getLogOdds() : OccupancyGrid::kUnknown;
    octomap::OcTreeNode* const updated = OcTree::updateNode(key, log_odds_update, lazy_eval);
    if (updated->getLogOdds() != before) changes_.push_back({VoxelOf(key), updated->getLogOdds()});
    return updated;
  }

  void ForgetChanges() { changes_.clear(); }
  std::span<const VoxelChange> changes() const { return changes_; }

 private:
  std::vector<VoxelChange> changes_;
};

OctreeMap::OctreeMap(const OccupancyMap::Options& options)
    : OctreeMap(options, OccupancyGrid(Checked(options).voxel_size)) {}

OctreeMap::OctreeMap(const OccupancyMap::Options& options, const OccupancyGrid& map)
    : options_(Checked(options)), tree_(std::make_unique<Tree>(options_)) {
  Require(map.voxel_size() == options_.voxel_size, "voxel_size", options_.voxel_size,
          ("that of the map to resume from, " + NumberText(map.voxel_size())).c_str());
  tree_->Restore(map);
}

OctreeMap::~OctreeMap() = default;

const octomap::OcTree& OctreeMap::tree() const {
  return *tree_;
}

bool OctreeMap::empty() const {
  return tree_->size() == 0;
}

std::span<const VoxelChange> OctreeMap::Integrate(const PointCloud& cloud, const RigidTransform& T_WC) {
  tree_->ForgetChanges();
  hits_.clear();
  hit_voxels_.clear();
  const Eigen::Matrix3f R_WC = T_WC.linear().cast<float>();
  const Eigen::Vector3f p_WC = T_WC.translation().cast<float>();
  const double reach = options_.voxel_size * (kMaxVoxelIndex - ScanMarks::kMaxReach);
  if (!(p_WC.cast<double>().cwiseAbs().maxCoeff() < reach)) return tree_->changes();
  const octomap::point3d origin = PointFrom(p_WC);
  octomap::Pointcloud points_W;
  points_W.reserve(cloud.points_C.size());
  VoxelBatch batch;
  const std::span<const Eigen::Vector3f> points(cloud.points_C);
  for (std::size_t first = 0; first < points.size(); first += VoxelBatch::kSize) {
    const std::size_t count = std::min(VoxelBatch::kSize, points.size() - first);
    PlaceInVoxels(points.subspan(first, count), R_WC, p_WC, options_.voxel_size, options_.min_range, batch);
    for (std::size_t k = 0; k < count; ++k) {
      if (batch.x[k] == VoxelBatch::kNone) continue;
      const VoxelIndex voxel{batch.x[k], batch.y[k], batch.z[k]};
      points_W.push_back(PointFrom(ToWorld(R_WC, p_WC, points[first + k])));
      const octomap::point3d end = options_.exact_rays ? points_W.back() : tree_->keyToCoord(KeyOf(voxel));
      const bool in_range = (end - origin).norm() <= options_.max_range;
      if (in_range && hit_voxels_.insert(voxel).second) {
        hits_.push_back({voxel, static_cast<std::uint32_t>(first + k)});
      }
    }
  }
  if (options_.no_return) {
    AddNoReturns(cloud, *options_.no_return, options_.max_range, R_WC, p_WC, points_W);
  }
  tree_->insertPointCloud(points_W, origin, options_.max_range, /*lazy_eval=*/false,
                          /*discretize=*/!options_.exact_rays);
  return tree_->changes();
}

OccupancyGrid OctreeMap::Snapshot() const {
  OccupancyGrid grid(options_.voxel_size);
  for (auto leaf = tree_->begin_leafs(); leaf != tree_->end_leafs(); ++leaf) {
    const std::int32_t edge = 1 << (tree_->getTreeDepth() - leaf.getDepth());
    const VoxelIndex low = VoxelOf(leaf.getIndexKey());
    ForEachVoxel({low, low + VoxelIndex{edge, edge, edge}},
                 [&](const VoxelIndex& voxel) { grid.Set(voxel, leaf->getLogOdds()); });
  }
  return grid;
}

}  // namespace thalweg::mapper
