#include "services/mapper/core/octree_map.h"

#include <gtest/gtest.h>
#include <octomap/ScanGraph.h>
#include <octomap/octomap.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "services/mapper/core/octomap_keys.h"
#include "tests/services/mapper/adapter/example_map.h"
#include "tests/services/mapper/core/octomap_peer.h"
#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::OctomapPeer;

using Scan = std::pair<PointCloud, RigidTransform>;

std::vector<Scan> ScansOfARoom(int count, unsigned seed) {
  std::mt19937 random(seed);
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const auto camera = PinholeCamera::FromFieldOfView(80, 60, 1.3);
  std::vector<Scan> scans;
  for (int n = 0; n < count; ++n) {
    const RigidTransform T_WC = room.RandomPose(random);
    scans.emplace_back(room.Render(camera, T_WC), T_WC);
  }
  return scans;
}

OccupancyMap::Options OptionsWith(double voxel_size, double max_range, bool discretize) {
  OccupancyMap::Options options;
  options.voxel_size = voxel_size;
  options.max_range = max_range;
  options.min_range = 0.0;
  options.exact_rays = !discretize;
  return options;
}

using Voxels = std::unordered_set<VoxelIndex, VoxelIndexHash>;

std::string Contents(const octomap::OcTree& tree) {
  std::ostringstream out;
  tree.writeData(out);
  return out.str();
}

struct TreeCase {
  double voxel_size;
  double max_range;
  bool discretize;
};

class OctreeMapBesideOctomap : public testing::TestWithParam<TreeCase> {};

// All rules of OccupancyMap are on, which must not matter.
TEST_P(OctreeMapBesideOctomap, IsTheTreeThatItsOwnInsertionBuilds) {
  const auto [voxel_size, max_range, discretize] = GetParam();
  const OccupancyMap::Options options = OptionsWith(voxel_size, max_range, discretize);
  OctreeMap ours(options);
  OctomapPeer theirs(options);
  for (const auto& [cloud, T_WC] : ScansOfARoom(10, 41)) {
    ours.Integrate(cloud, T_WC);
    theirs.Insert(OctomapPeer::ToWorld(cloud, T_WC), T_WC, max_range, /*lazy=*/false, discretize);
    ASSERT_EQ(Contents(ours.tree()), Contents(theirs)) << "leaves, inner nodes and pruning";
  }
  EXPECT_EQ(theirs.Differences(ours.Snapshot()), 0U);
}

TEST_P(OctreeMapBesideOctomap, HitsAreTheVoxelsThatItCallsOccupiedInAScan) {
  const auto [voxel_size, max_range, discretize] = GetParam();
  const OccupancyMap::Options options = OptionsWith(voxel_size, max_range, discretize);
  OctreeMap ours(options);
  OctomapPeer theirs(options);
  for (const auto& [cloud, T_WC] : ScansOfARoom(3, 42)) {
    ours.Integrate(cloud, T_WC);
    const Eigen::Vector3f p_WC = T_WC.translation().cast<float>();
    octomap::KeySet free, occupied;
    const octomap::Pointcloud points_W = OctomapPeer::ToWorld(cloud, T_WC);
    const octomap::point3d origin(p_WC.x(), p_WC.y(), p_WC.z());
    if (discretize) {
      theirs.computeDiscreteUpdate(points_W, origin, free, occupied, max_range);
    } else {
      theirs.computeUpdate(points_W, origin, free, occupied, max_range);
    }
    EXPECT_GT(occupied.size(), 20U);
    Voxels theirs_hit;
    for (const octomap::OcTreeKey& key : occupied) theirs_hit.insert(VoxelOf(key));
    Voxels hits;
    for (const Hit& hit : ours.hits()) {
      hits.insert(hit.voxel);
      EXPECT_EQ(VoxelAt((T_WC.cast<float>() * cloud.points_C[hit.pixel]).cast<double>(), voxel_size),
                hit.voxel);
    }
    EXPECT_EQ(hits, theirs_hit);
    EXPECT_EQ(hits.size(), ours.hits().size()) << "each voxel once";
  }
}

INSTANTIATE_TEST_SUITE_P(SizesAndRanges, OctreeMapBesideOctomap,
                         testing::Values(TreeCase{0.1, 5.0, false}, TreeCase{0.1, 5.0, true},
                                         TreeCase{0.1, 1.3, false}, TreeCase{0.05, 3.0, true},
                                         TreeCase{0.33, 2.0, false}),
                         [](const testing::TestParamInfo<TreeCase>& tested) {
                           return std::to_string(static_cast<int>(tested.param.voxel_size * 100)) + "cm_" +
                                  std::to_string(static_cast<int>(tested.param.max_range * 10)) + "dm" +
                                  (tested.param.discretize ? "_discretized" : "");
                         });

TEST(OctreeMap, ItsChangesAreThoseOfOctomapsChangeDetectionAndThoseOfLogOddsAlone) {
  const OccupancyMap::Options options = OptionsWith(0.1, 5.0, false);
  OctreeMap ours(options);
  OctomapPeer theirs(options);
  theirs.enableChangeDetection(true);
  std::size_t of_class = 0;
  for (const auto& [cloud, T_WC] : ScansOfARoom(12, 43)) {
    const OccupancyGrid before = ours.Snapshot();
    const auto changes = ours.Integrate(cloud, T_WC);
    theirs.Insert(OctomapPeer::ToWorld(cloud, T_WC), T_WC, options.max_range, /*lazy=*/false,
                  /*discretize=*/false);
    Voxels changed_class;
    for (const VoxelChange& change : changes) {
      EXPECT_NE(before.LogOdds(change.voxel), change.log_odds);
      if (before.State(change.voxel) != OccupancyGrid::StateOf(change.log_odds)) {
        changed_class.insert(change.voxel);
      }
    }
    Voxels detected;
    for (auto it = theirs.changedKeysBegin(); it != theirs.changedKeysEnd(); ++it)
      detected.insert(VoxelOf(it->first));
    EXPECT_EQ(changed_class, detected);
    of_class += detected.size();
    theirs.resetChangeDetection();
  }
  EXPECT_GT(of_class, 10000U);
}

TEST(OctreeMap, StaysPrunedAndAnswersAtEveryResolution) {
  OctreeMap map(OptionsWith(0.1, 5.0, false));
  for (int again = 0; again < 6; ++again) {  // until the free space is clamped
    for (const auto& [cloud, T_WC] : ScansOfARoom(8, 44)) map.Integrate(cloud, T_WC);
  }
  const OccupancyGrid grid = map.Snapshot();
  std::size_t known = 0;
  grid.ForEachKnown([&](const VoxelIndex&, float) { ++known; });
  EXPECT_LT(map.tree().getNumLeafNodes(), known / 2) << "equal siblings are one leaf";
  // OctoMap's multi-resolution query: a node's log-odds are the largest of the voxels in it.
  std::map<std::array<int, 3>, float> largest;
  grid.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    const auto [node, is_new] = largest.try_emplace({i.x >> 2, i.y >> 2, i.z >> 2}, log_odds);
    if (!is_new) node->second = std::max(node->second, log_odds);
  });
  for (const auto& [node, log_odds] : largest) {
    const octomap::OcTreeNode* const found =
        map.tree().search(KeyOf({4 * node[0], 4 * node[1], 4 * node[2]}), 14);
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->getLogOdds(), log_odds);
  }
  EXPECT_GT(largest.size(), 1000U);
}

TEST(OctreeMap, RulesBeyondOctomapHaveNoEffectOnIt) {
  OccupancyMap::Options with = OptionsWith(0.1, 5.0, false);
  OccupancyMap::Options without = with;
  without.protect = without.fill = false;
  without.shadow = 0.0;
  with.depth_error.sigma = 0.01;
  OctreeMap a(with);
  OctreeMap b(without);
  for (const auto& [cloud, T_WC] : ScansOfARoom(4, 45)) {
    a.Integrate(cloud, T_WC);
    b.Integrate(cloud, T_WC);
  }
  EXPECT_TRUE(a.Snapshot().SameAs(b.Snapshot()));
}

/// Scans whose pose is a translation, as graph2tree multiplies other poses out in its own order. In 3D they
/// look in all directions: each cloud is turned before.
std::vector<Scan> UprightScans(int count, unsigned seed) {
  std::vector<Scan> scans = ScansOfARoom(count, seed);
  for (auto& [cloud, T_WC] : scans) {
    for (Eigen::Vector3f& p_C : cloud.points_C) p_C = T_WC.linear().cast<float>() * p_C;
    T_WC.linear().setIdentity();
    for (double& value : T_WC.translation()) value = static_cast<double>(static_cast<float>(value));
  }
  return scans;
}

TEST(OctreeMap, IsToTheLastVoxelWhatOctomapsOwnToolMakesOfTheSameClouds) {
  if (std::system("command -v graph2tree > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "graph2tree, of package octomap-tools, is not installed";
  }
  const test::TestFolder folder;
  for (const bool discretize : {false, true}) {
    // The tool's sensor model is OctoMap's own.
    OccupancyMap::Options options = OptionsWith(0.1, 4.0, discretize);
    const octomap::OcTree model(options.voxel_size);
    options.log_odds_hit = model.getProbHitLog();
    options.log_odds_miss = model.getProbMissLog();
    options.log_odds_min = model.getClampingThresMinLog();
    options.log_odds_max = model.getClampingThresMaxLog();
    OctreeMap map(options);
    octomap::ScanGraph graph;
    for (const auto& [cloud, T_WC] : UprightScans(8, 46)) {
      map.Integrate(cloud, T_WC);
      auto points = std::make_unique<octomap::Pointcloud>();
      for (const Eigen::Vector3f& p_C : cloud.points_C) {
        if (p_C.allFinite()) points->push_back(p_C.x(), p_C.y(), p_C.z());
      }
      const Eigen::Vector3f p_W = T_WC.translation().cast<float>();
      // The graph takes over the points.
      graph.addNode(points.release(), octomap::pose6d(p_W.x(), p_W.y(), p_W.z(), 0.0, 0.0, 0.0));
    }
    const std::string file = (folder.path() / "scans.graph").string();
    const std::string tree_file = (folder.path() / "tree.bt").string();
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    ASSERT_TRUE(graph.writeBinary(file));
    const std::string command = "graph2tree -i '" + file + "' -o '" + tree_file + "' -res 0.1 -m 4" +
                                (discretize ? " -discretize" : "") + " > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(tree_file + ".ot"));
    testing::internal::GetCapturedStdout();
    testing::internal::GetCapturedStderr();
    auto* const theirs = dynamic_cast<octomap::OcTree*>(read.get());
    ASSERT_NE(theirs, nullptr);
    theirs->expand();
    std::size_t known = 0;
    std::size_t different = 0;
    map.Snapshot().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
      ++known;
      const octomap::OcTreeNode* const node = theirs->search(KeyOf(i));
      different += node == nullptr || node->getLogOdds() != log_odds ? 1 : 0;
    });
    EXPECT_GT(known, 10000U);
    EXPECT_EQ(theirs->getNumLeafNodes(), known);
    EXPECT_EQ(different, 0U);
  }
}

}  // namespace
}  // namespace thalweg::mapper
