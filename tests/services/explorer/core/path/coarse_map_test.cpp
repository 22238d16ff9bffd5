#include "services/explorer/core/path/coarse_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "tests/services/explorer/support/random_planning_map.h"
#include "tests/services/explorer/support/reached_places.h"

namespace thalweg::explorer {
namespace {

class CoarseMaps : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, CoarseMaps, testing::Range(1U, 13U));

TEST_P(CoarseMaps, KnowPathLengthsToWithinATenthAndThreeVoxels) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {50, 40, 22}}, 26, 10));
  PathSearch search;
  const std::vector<VoxelIndex> places = test::ReachedPlaces(map, 8, random, search);
  CoarseMap coarse(map, search);
  const auto distances = coarse.Distances(places);
  const auto from_each = coarse.DistancesFromEach(places, places);
  PathSearch exact;
  for (std::size_t a = 0; a < places.size(); ++a) {
    exact.Flood(map, {{places[a], 0}});
    const std::vector<double> from_a = coarse.DistancesFrom(places[a], places);
    EXPECT_EQ(from_each[a], from_a) << "the same on all cores";
    for (std::size_t b = 0; b < places.size(); ++b) {
      // Cells may cut a corner, or lead around one that the voxels cut.
      EXPECT_GE(distances[a][b], 0.8 * exact.Length(places[b]) - 0.3);
      EXPECT_LE(distances[a][b], 1.2 * exact.Length(places[b]) + 0.3);
      EXPECT_NEAR(from_a[b], distances[a][b], 1e-9);
      EXPECT_LE(coarse.LeastDistance(places[a], places[b]), 1.003 * exact.Length(places[b]) + 1e-9);
    }
    const std::vector<double> near_a = coarse.DistancesFrom(places[a], places, 2.0);
    for (std::size_t b = 0; b < places.size(); ++b) {
      // A cell lies within 2 m or not by its cost, which a straight line or the robot's path may replace.
      EXPECT_FALSE(from_a[b] < 1.4 && std::isinf(near_a[b])) << from_a[b];
      EXPECT_FALSE(from_a[b] > 2.6 && !std::isinf(near_a[b])) << from_a[b];
      EXPECT_TRUE(near_a[b] == from_a[b] || std::isinf(near_a[b])) << from_a[b];
    }
  }
}

/// Costs between cells of 3 x 3 x 3 voxels by the textbook form of Dijkstra's algorithm [hundredths of a
/// cell]: from cell to cell over up to three faces, each on another axis, where two reached voxels touch.
std::map<std::array<int, 3>, int> CellCosts(const PlanningMap& map, const PathSearch& search,
                                            const VoxelIndex& from) {
  using Cell = std::array<int, 3>;
  const auto cell_of = [&](const VoxelIndex& i) {
    const VoxelIndex at = i - map.box().min;
    return Cell{at.x / CoarseMap::kEdge, at.y / CoarseMap::kEdge, at.z / CoarseMap::kEdge};
  };
  std::map<Cell, std::set<Cell>> doors;
  test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
    for (const VoxelIndex& d : kFaceNeighbors) {
      if (search.Reached(i) && search.Reached(i + d) && cell_of(i) != cell_of(i + d))
        doors[cell_of(i)].insert(cell_of(i + d));
    }
  });
  const auto moved = [](const Cell& a, const Cell& b) {
    return std::array<bool, 3>{a[0] != b[0], a[1] != b[1], a[2] != b[2]};
  };
  std::map<Cell, int> costs;
  std::set<std::pair<int, Cell>> open = {{0, cell_of(from)}};
  while (!open.empty()) {
    const auto [cost, at] = *open.begin();
    open.erase(open.begin());
    if (!costs.try_emplace(at, cost).second) continue;
    for (const Cell& a : doors[at]) {
      open.insert({cost + 100, a});
      for (const Cell& b : doors[a]) {
        if (moved(at, a) == moved(a, b)) continue;
        open.insert({cost + 141, b});
        for (const Cell& c : doors[b]) {
          if (moved(b, c) != moved(a, b) && moved(b, c) != moved(at, a)) open.insert({cost + 173, c});
        }
      }
    }
  }
  return costs;
}

TEST_P(CoarseMaps, FindTheShortestPathsThroughTheirCells) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {50, 40, 22}}, 40, 10));
  const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map);
  PathSearch search;
  search.Flood(map, {{traversable[random() % traversable.size()], 0}});
  std::vector<VoxelIndex> reached;
  for (const VoxelIndex& i : traversable) {
    if (search.Reached(i)) reached.push_back(i);
  }
  CoarseMap coarse(map, search);
  for (int n = 0; n < 3; ++n) {
    const VoxelIndex from = reached[random() % reached.size()];
    const auto costs = CellCosts(map, search, from);
    const std::vector<double> distances = coarse.DistancesFrom(from, reached);
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const VoxelIndex at = reached[k] - map.box().min;
      const auto cost =
          costs.find({at.x / CoarseMap::kEdge, at.y / CoarseMap::kEdge, at.z / CoarseMap::kEdge});
      const double straight = (map.CenterOf(from) - map.CenterOf(reached[k])).norm();
      const double over_robot = search.Length(from) + search.Length(reached[k]);
      // Up to two cells, the coarse cost means nothing.
      const double over_cells = cost == costs.end()   ? over_robot
                                : cost->second <= 200 ? straight
                                                      : cost->second * 0.01 * CoarseMap::kEdge * 0.1;
      ASSERT_NEAR(distances[k], std::max(straight, std::min(over_cells, over_robot)), 1e-9);
    }
  }
}

TEST(CoarseMap, AWallOfOneVoxelLetsNoPathThrough) {
  // Two rooms side by side, connected at the far end only.
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {60, 21, 12}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{0, 10, 0}, {50, 11, 12}}, VoxelState::kOccupied));
  PathSearch search;
  const VoxelIndex here{5, 5, 6};
  const VoxelIndex beyond{5, 15, 6};
  search.Flood(map, {{here, 0}});
  ASSERT_TRUE(search.Reached(beyond));
  EXPECT_GT(CoarseMap(map, search).Distances({here, beyond})[0][1], 8.0);
}

TEST(CoarseMap, ReportsWhatIsUnknownBehindAFrontier) {
  // A room with one side open to an unknown room of 30 x 12 x 12 voxels, and a niche in another side.
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(6.0, 1.2, 1.2));
  PlanningMap map({.voxel_size = 0.1, .clearance = 0.15, .bounds = bounds});
  map.Apply(test::BoxOf({{0, 0, 0}, {30, 12, 12}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{0, 0, 0}, {3, 12, 12}}, VoxelState::kOccupied));
  map.Apply(test::BoxOf({{0, 3, 3}, {3, 9, 9}}, VoxelState::kUnknown));
  PathSearch search;
  search.Flood(map, {{{15, 6, 6}, 0}});
  const std::vector<VoxelIndex> open_left = {{30, 2, 5}, {30, 3, 5}, {30, 4, 5}};
  const std::vector<VoxelIndex> open_right = {{30, 8, 5}};
  const std::vector<VoxelIndex> niche = {{2, 5, 5}, {2, 6, 5}};
  const std::vector<double> volumes =
      CoarseMap(map, search).WorthBehind({&open_left, &open_right, &niche}, [](double volume) {
        return volume;
      });
  // Cells at the rims of the unknown space contain too little of it to be dark.
  EXPECT_GT(volumes[0] + volumes[1], 0.7 * 30 * 12 * 12);
  EXPECT_LE(volumes[0] + volumes[1], 30 * 12 * 12);
  EXPECT_DOUBLE_EQ(volumes[0], 3.0 * volumes[1]);
  EXPECT_GT(volumes[2], 0.0);
  EXPECT_LE(volumes[2], 3 * 6 * 6);
}

}  // namespace
}  // namespace thalweg::explorer
