#include "services/evaluator/core/view_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <random>
#include <set>
#include <stdexcept>

#include "common/voxel/ray.h"

namespace thalweg::evaluator {
namespace {

using Set = DenseGrid<std::uint8_t>;

Set BoxSet(int x, int y, int z) {
  return Set({{-1, 2, -3}, {x - 1, y + 2, z - 3}}, 1);
}

double StraightLength(const ViewLattice& lattice, std::size_t a, std::size_t b) {
  return (VoxelCenter(lattice.places[a], lattice.voxel_size) -
          VoxelCenter(lattice.places[b], lattice.voxel_size))
      .norm();
}

/// What is connected over faces to the first voxel of a random set: winding and narrow.
Set RandomSet(std::uint32_t seed) {
  std::mt19937 random(seed);
  Set walls({{0, 0, 0}, {14, 12, 6}}, 0);
  for (std::size_t k = 0; k < walls.size(); ++k) walls[k] = random() % 100 < 35 ? 0 : 1;
  Set set(walls.box(), 0);
  std::queue<VoxelIndex> open;
  open.push({7, 6, 3});
  walls[(VoxelIndex{7, 6, 3})] = 1;
  set[(VoxelIndex{7, 6, 3})] = 1;
  while (!open.empty()) {
    const VoxelIndex at = open.front();
    open.pop();
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex next = at + step;
      if (walls.Get(next, 0) == 0 || set[next] != 0) continue;
      set[next] = 1;
      open.push(next);
    }
  }
  return set;
}

TEST(ViewLattice, InABoxIsALatticeAndItsWaysAreNearlyStraight) {
  const Set box = BoxSet(13, 10, 7);
  const ViewLattice lattice = LatticeOn(box, 0.1, 3, 0);
  EXPECT_EQ(lattice.step, 3);
  EXPECT_EQ(lattice.places.size(), 5U * 4 * 3);
  ShortestPaths paths(lattice.graph);
  double longest = 0.0;
  for (std::size_t a = 0; a < lattice.places.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      longest = std::max(longest, paths.Length(a, b) / StraightLength(lattice, a, b));
      EXPECT_GE(paths.Length(a, b), StraightLength(lattice, a, b) - 1e-6);
    }
  }
  EXPECT_LE(longest, 1.05);
}

TEST(ViewLattice, NoLinkLeavesTheSetUnlessItIsLongerThanTheStraightLine) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Set set = RandomSet(seed);
    const ViewLattice lattice = LatticeOn(set, 0.1, 3, 0);
    std::size_t straight = 0;
    for (std::size_t a = 0; a < lattice.places.size(); ++a) {
      for (const PlaceGraph::Link& link : lattice.graph.links[a]) {
        ASSERT_GE(link.length, StraightLength(lattice, a, link.to) - 1e-6);
        // Through an edge or a corner the traversal depends on its direction.
        const auto inside_from = [&](std::size_t from, std::size_t to) {
          return TraverseVoxels(VoxelCenter(lattice.places[from], 1.0), VoxelCenter(lattice.places[to], 1.0),
                                1.0, [&](const VoxelIndex& i) { return set.Get(i, 0) != 0; });
        };
        const bool inside = inside_from(a, link.to) || inside_from(link.to, a);
        straight += inside ? 1U : 0U;
        EXPECT_TRUE(inside || link.length > StraightLength(lattice, a, link.to) + 1e-3);
      }
    }
    EXPECT_GT(straight, 20U);
  }
}

TEST(ViewLattice, AllPlacesAreConnectedHoweverNarrowTheSet) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Set set = RandomSet(seed);
    for (const int step : {1, 2, 4}) {
      const ViewLattice lattice = LatticeOn(set, 0.1, step, 0);
      ShortestPaths paths(lattice.graph);
      for (std::size_t n = 0; n < lattice.places.size(); ++n) {
        ASSERT_TRUE(std::isfinite(paths.Length(0, n))) << "seed " << seed << ", step " << step;
      }
      const auto in_set = [&](const VoxelIndex& i) { return set.Get(i, 0) != 0; };
      EXPECT_TRUE(std::all_of(lattice.places.begin(), lattice.places.end(), in_set));
    }
  }
}

/// Shortest paths over face neighbors, which no path over places inside the same set undercuts by more than
/// a straight line does.
TEST(ViewLattice, PathsAreNoShorterThanTheStraightestWalkOverVoxelsAllows) {
  const Set set = RandomSet(4);
  const ViewLattice lattice = LatticeOn(set, 1.0, 2, 0);
  ShortestPaths paths(lattice.graph);
  DenseGrid<int> steps(set.box(), -1);
  std::queue<VoxelIndex> open;
  open.push(lattice.places[0]);
  steps[lattice.places[0]] = 0;
  while (!open.empty()) {
    const VoxelIndex at = open.front();
    open.pop();
    for (const VoxelIndex& step : kFaceNeighbors) {
      if (set.Get(at + step, 0) == 0 || steps[at + step] >= 0) continue;
      steps[at + step] = steps[at] + 1;
      open.push(at + step);
    }
  }
  for (std::size_t n = 0; n < lattice.places.size(); ++n) {
    // A straight line of length l crosses at most sqrt(3) l faces.
    EXPECT_GE(paths.Length(0, n) * std::sqrt(3.0), steps[lattice.places[n]] - 1e-3);
  }
}

TEST(ViewLattice, HasNoMorePlacesThanItMay) {
  const Set box = BoxSet(40, 30, 20);
  const ViewLattice lattice = LatticeOn(box, 0.1, 2, 300);
  EXPECT_LE(lattice.places.size(), 300U);
  EXPECT_GT(lattice.places.size(), 100U);
  EXPECT_GT(lattice.step, 2);
  EXPECT_THROW(LatticeOn(box, 0.1, 0, 0), std::invalid_argument);
}

TEST(ViewLattice, APlaceThatIsAddedIsLinkedAndOneThatIsThereIsNotAddedAgain) {
  const Set box = BoxSet(13, 10, 7);
  ViewLattice lattice = LatticeOn(box, 0.1, 3, 0);
  const std::size_t before = lattice.places.size();
  EXPECT_EQ(lattice.Add(box, lattice.places[5]), 5U);
  const std::size_t added = lattice.Add(box, {3, 6, 0});
  EXPECT_EQ(added, before);
  ShortestPaths paths(lattice.graph);
  EXPECT_TRUE(std::isfinite(paths.Length(added, 0)));
  EXPECT_FALSE(lattice.graph.links[added].empty());
}

}  // namespace
}  // namespace thalweg::evaluator
