#include "services/explorer/core/map/frontier.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using Key = std::array<int, 3>;

Key KeyOf(const VoxelIndex& i) {
  return {i.x, i.y, i.z};
}

std::set<Key> KeysOf(const std::vector<VoxelIndex>& voxels) {
  std::set<Key> keys;
  for (const VoxelIndex& i : voxels) keys.insert(KeyOf(i));
  EXPECT_EQ(keys.size(), voxels.size());
  return keys;
}

/// Unknown voxels within the bounds that are next to a free voxel within the bounds.
std::vector<VoxelIndex> BruteTargets(const PlanningMap& map) {
  std::vector<VoxelIndex> targets;
  test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
    bool beside_free = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        const VoxelIndex j = i + VoxelIndex{axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0};
        beside_free |= map.InBounds(j) && map.State(j) == VoxelState::kFree;
      }
    }
    if (map.State(i) == VoxelState::kUnknown && map.InBounds(i) && beside_free) targets.push_back(i);
  });
  return targets;
}

/// Components by comparing all voxels with all others until nothing changes.
std::set<std::set<Key>> BruteComponents(const std::vector<VoxelIndex>& voxels) {
  std::vector<std::size_t> label(voxels.size());
  std::iota(label.begin(), label.end(), 0U);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t a = 0; a < voxels.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const VoxelIndex d = voxels[a] - voxels[b];
        if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) > 1 || label[a] == label[b]) continue;
        label[a] = label[b] = std::min(label[a], label[b]);
        changed = true;
      }
    }
  }
  std::map<std::size_t, std::set<Key>> sorted;
  for (std::size_t n = 0; n < voxels.size(); ++n) sorted[label[n]].insert(KeyOf(voxels[n]));
  std::set<std::set<Key>> components;
  for (auto& [name, keys] : sorted) components.insert(std::move(keys));
  return components;
}

DenseGrid<std::uint8_t> NothingAside(const PlanningMap& map) {
  return {map.box(), 0};
}

class Frontier : public testing::TestWithParam<unsigned> {
 protected:
  Frontier() { map_.Apply(test::RandomScene(random_, {{-3, -3, -3}, {13, 12, 11}}, 14, 4)); }

  std::mt19937 random_{GetParam()};
  PlanningMap map_{GetParam() % 2 == 0
                       ? PlanningMap::Options{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}
                       : PlanningMap::Options{.voxel_size = 0.1,
                                              .clearance = 0.15,
                                              .bounds = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0),
                                                                            Eigen::Vector3d(1.1, 1.2, 1.0))}};
};
INSTANTIATE_TEST_SUITE_P(Seeds, Frontier, testing::Range(1U, 9U));

TEST_P(Frontier, TargetsAreTheUnknownVoxelsBesideFreeOnes) {
  const std::set<Key> expected = KeysOf(BruteTargets(map_));
  test::ForEachVoxel(map_.box(),
                     [&](const VoxelIndex& i) { EXPECT_EQ(IsTarget(map_, i), expected.contains(KeyOf(i))); });
}

TEST_P(Frontier, ComponentsEqualBruteForceAndSmallOnesAreCounted) {
  constexpr int kLeast = 4;
  const Frontiers found =
      FindFrontiers(map_, NothingAside(map_), {.min_area = 0.01 * kLeast, .extent = 100.0});
  std::set<std::set<Key>> expected;
  std::size_t small_clusters = 0;
  std::size_t small_voxels = 0;
  for (const std::set<Key>& component : BruteComponents(BruteTargets(map_))) {
    if (component.size() >= kLeast) {
      expected.insert(component);
    } else {
      ++small_clusters;
      small_voxels += component.size();
    }
  }
  std::set<std::set<Key>> components;
  for (const Cluster& cluster : found.clusters) components.insert(KeysOf(cluster.unknowns));
  EXPECT_EQ(components, expected);
  EXPECT_EQ(found.small_clusters, small_clusters);
  EXPECT_EQ(found.small_voxels, small_voxels);
}

TEST(VoxelsOfArea, CoverItWhateverTheirSize) {
  EXPECT_EQ(VoxelsOfArea(0.1, 0.1), 10U);
  EXPECT_EQ(VoxelsOfArea(0.1, 0.05), 40U);
  EXPECT_EQ(VoxelsOfArea(0.1, 0.2), 3U);
  EXPECT_EQ(VoxelsOfArea(0.0, 0.1), 1U);
}

TEST_P(Frontier, ClustersFitIntoTheExtentAndTogetherAreTheComponents) {
  constexpr int kExtent = 3;
  const Frontiers found =
      FindFrontiers(map_, NothingAside(map_), {.min_area = 0.01, .extent = 0.1 * kExtent});
  const auto components = BruteComponents(BruteTargets(map_));
  std::set<Key> all;
  for (const Cluster& cluster : found.clusters) {
    ASSERT_FALSE(cluster.unknowns.empty());
    Eigen::Array3i low = Eigen::Array3i::Constant(1000);
    Eigen::Array3i high = Eigen::Array3i::Constant(-1000);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const VoxelIndex& i : cluster.unknowns) {
      EXPECT_TRUE(all.insert(KeyOf(i)).second) << "in two clusters";
      low = low.min(Eigen::Array3i(i.x, i.y, i.z));
      high = high.max(Eigen::Array3i(i.x, i.y, i.z));
      sum += map_.CenterOf(i);
    }
    EXPECT_LE((high - low).maxCoeff(), kExtent - 1);
    EXPECT_LT((sum / static_cast<double>(cluster.unknowns.size()) - cluster.center_W).norm(), 1e-9);
    const std::set<Key> keys = KeysOf(cluster.unknowns);
    EXPECT_EQ(std::count_if(components.begin(), components.end(),
                            [&](const std::set<Key>& component) {
                              return std::includes(component.begin(), component.end(), keys.begin(),
                                                   keys.end());
                            }),
              1);
  }
  EXPECT_EQ(all, KeysOf(BruteTargets(map_)));
}

TEST_P(Frontier, DoubtfulVoxelsMakeClustersOfTheirOwn) {
  PlanningMap::Options options = map_.options();
  options.doubt = {.max_log_odds = 0.5, .weight = 0.7};
  PlanningMap map(options);
  std::vector<VoxelChange> changes;
  test::ForEachVoxel(map_.box(), [&](const VoxelIndex& i) {
    if (map_.State(i) == VoxelState::kUnknown) return;
    const float sure = test::LogOddsOf(map_.State(i));
    changes.push_back({i, random_() % 5 == 0 ? 0.4F * sure : sure});
  });
  map.Apply(changes);
  std::vector<VoxelIndex> doubtful;
  for (const VoxelChange& change : changes) {
    const VoxelIndex& i = change.voxel;
    if (std::abs(change.log_odds) > 0.5F || !map.InBounds(i)) continue;
    const bool beside_free = std::any_of(
        std::begin(kFaceNeighbors), std::end(kFaceNeighbors),
        [&](const VoxelIndex& d) { return map.InBounds(i + d) && map.State(i + d) == VoxelState::kFree; });
    if (beside_free) doubtful.push_back(i);
  }
  constexpr int kLeast = 3;
  const Frontiers found = FindFrontiers(map, NothingAside(map), {.min_area = 0.01 * kLeast, .extent = 100.0});
  const Frontiers without =
      FindFrontiers(map_, NothingAside(map_), {.min_area = 0.01 * kLeast, .extent = 100.0});
  std::set<std::set<Key>> expected;
  std::size_t small = 0;
  for (const std::set<Key>& component : BruteComponents(doubtful)) {
    if (component.size() >= kLeast) expected.insert(component);
    small += component.size() < kLeast ? component.size() : 0;
  }
  EXPECT_FALSE(expected.empty());
  std::set<std::set<Key>> components;
  for (std::size_t n = 0; n < found.clusters.size(); ++n) {
    const Cluster& cluster = found.clusters[n];
    if (n < without.clusters.size()) {
      EXPECT_FALSE(cluster.doubtful);
      EXPECT_EQ(cluster.weight, 1.0);
      EXPECT_EQ(cluster.unknowns, without.clusters[n].unknowns) << "as without any doubt";
    } else {
      EXPECT_TRUE(cluster.doubtful);
      EXPECT_EQ(cluster.weight, 0.7);
      components.insert(KeysOf(cluster.unknowns));
    }
  }
  EXPECT_EQ(components, expected);
  EXPECT_EQ(found.small_doubtful_voxels, small);
  EXPECT_EQ(found.small_voxels, without.small_voxels);
}

TEST_P(Frontier, WhatIsSetAsideIsLeftOut) {
  DenseGrid<std::uint8_t> aside = NothingAside(map_);
  std::vector<VoxelIndex> left;
  for (const VoxelIndex& i : BruteTargets(map_)) {
    if (random_() % 2 == 0) {
      aside[i] = 1;
    } else {
      left.push_back(i);
    }
  }
  std::set<std::set<Key>> components;
  for (const Cluster& cluster : FindFrontiers(map_, aside, {.min_area = 0.01, .extent = 100.0}).clusters) {
    components.insert(KeysOf(cluster.unknowns));
  }
  EXPECT_EQ(components, BruteComponents(left));
}

}  // namespace
}  // namespace thalweg::explorer
