#include "services/explorer/core/path/path_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kSize;
using Obstacles = PlanningMap::Obstacles;
using Costs = std::unordered_map<VoxelIndex, std::uint32_t, VoxelIndexHash>;

std::uint32_t StepCost(const VoxelIndex& from, const VoxelIndex& to) {
  const VoxelIndex d = to - from;
  const int axes = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  const bool neighbors = std::abs(d.x) <= 1 && std::abs(d.y) <= 1 && std::abs(d.z) <= 1 && axes > 0;
  if (!neighbors) return PathSearch::kUnreached;
  return axes == 1 ? 100U : axes == 2 ? 141U : 173U;
}

/// Dijkstra's algorithm in its textbook form.
Costs ReferenceCosts(const PlanningMap& map, const PathSearch::Start& start) {
  const auto before = [](const VoxelIndex& a, const VoxelIndex& b) {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  };
  Costs costs;
  std::map<std::uint32_t, std::set<VoxelIndex, decltype(before)>> open;
  const auto reach = [&](const VoxelIndex& i, std::uint32_t cost) {
    const auto found = costs.find(i);
    if (found != costs.end() && found->second <= cost) return;
    costs[i] = cost;
    open.try_emplace(cost, before).first->second.insert(i);
  };
  for (const PathSearch::Entry& entry : start) reach(entry.voxel, entry.cost);
  while (!open.empty()) {
    const std::uint32_t cost = open.begin()->first;
    const auto voxels = open.begin()->second;
    open.erase(open.begin());
    for (const VoxelIndex& at : voxels) {
      if (costs[at] != cost) continue;
      const VoxelIndex one{1, 1, 1};
      test::ForEachVoxel({at - one, at + one + one}, [&](const VoxelIndex& i) {
        if (!(i == at) && map.Traversable(i)) reach(i, cost + StepCost(at, i));
      });
    }
  }
  return costs;
}

/// Sum of the steps of a path over traversable voxels; fails when it is not such a path.
std::uint32_t CostOf(const PlanningMap& map, const std::vector<VoxelIndex>& path) {
  std::uint32_t cost = 0;
  for (std::size_t n = 0; n < path.size(); ++n) {
    EXPECT_TRUE(map.Traversable(path[n]));
    if (n == 0) continue;
    const std::uint32_t step = StepCost(path[n - 1], path[n]);
    EXPECT_NE(step, PathSearch::kUnreached);
    cost += step;
  }
  return cost;
}

std::uint32_t EntryCost(const PathSearch::Start& start, const VoxelIndex& voxel) {
  for (const PathSearch::Entry& entry : start) {
    if (entry.voxel == voxel) return entry.cost;
  }
  ADD_FAILURE() << "the path does not begin at an entry";
  return 0;
}

class PathSearchOnRandomMaps : public testing::TestWithParam<unsigned> {
 protected:
  PathSearchOnRandomMaps() {
    map_.Apply(test::RandomScene(random_, {{0, 0, 0}, {18, 18, 14}}, 18, 6));
    traversable_ = test::TraversableVoxels(map_);
  }
  const VoxelIndex& Somewhere() { return traversable_[random_() % traversable_.size()]; }

  std::mt19937 random_{GetParam()};
  PlanningMap map_{{.voxel_size = kSize, .clearance = GetParam() % 2 == 0 ? 0.04 : 0.1, .bounds = {}}};
  std::vector<VoxelIndex> traversable_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, PathSearchOnRandomMaps, testing::Range(1U, 9U));

TEST_P(PathSearchOnRandomMaps, FloodAndAStarCostWhatDijkstraSays) {
  ASSERT_GT(traversable_.size(), 50U);
  PathSearch search;
  for (const PathSearch::Start& start :
       {PathSearch::Start{{Somewhere(), 0}},
        PathSearch::Start{{Somewhere(), 700}, {Somewhere(), 0}, {Somewhere(), 123}}, PathSearch::Start{}}) {
    search.Flood(map_, start);
    const Costs expected = ReferenceCosts(map_, start);
    EXPECT_EQ(search.reached_count(), expected.size());
    for (const VoxelIndex& i : traversable_) {
      const auto found = expected.find(i);
      ASSERT_EQ(search.Cost(i), found == expected.end() ? PathSearch::kUnreached : found->second);
    }
    for (int n = 0; n < 15; ++n) {
      const VoxelIndex goal = Somewhere();
      std::uint32_t cost = 0;
      const auto path = PathSearch::FindPath(map_, start, goal, &cost);
      ASSERT_EQ(path.has_value(), expected.contains(goal));
      if (!path) continue;
      EXPECT_EQ(cost, expected.at(goal));
      EXPECT_EQ(path->back(), goal);
      EXPECT_EQ(EntryCost(start, path->front()) + CostOf(map_, *path), cost);
    }
  }
}

TEST_P(PathSearchOnRandomMaps, AFloodForSomeVoxelsKnowsWhatTheyCostAndTheNextIsWhole) {
  PathSearch whole;
  PathSearch search;
  for (int n = 0; n < 10; ++n) {
    const PathSearch::Start start = {{Somewhere(), 0}, {Somewhere(), 250}};
    whole.Flood(map_, start);
    const std::vector<VoxelIndex> wanted = {Somewhere(), Somewhere(), Somewhere()};
    search.Flood(map_, start, wanted);
    for (const VoxelIndex& i : wanted) EXPECT_EQ(search.Cost(i), whole.Cost(i));
    search.Flood(map_, start);
    for (const VoxelIndex& i : traversable_) ASSERT_EQ(search.Cost(i), whole.Cost(i));
  }
}

TEST_P(PathSearchOnRandomMaps, PathsAreConnectedTraversableAndAsLongAsTheirCost) {
  PathSearch search;
  const PathSearch::Start start = {{Somewhere(), 40}, {Somewhere(), 0}};
  search.Flood(map_, start);
  for (const VoxelIndex& goal : traversable_) {
    if (!search.Reached(goal)) continue;
    const std::vector<VoxelIndex> path = search.PathTo(goal);
    EXPECT_EQ(path.back(), goal);
    EXPECT_EQ(EntryCost(start, path.front()) + CostOf(map_, path), search.Cost(goal));
    EXPECT_DOUBLE_EQ(search.Length(goal), search.Cost(goal) * 0.01 * kSize);
  }
}

TEST_P(PathSearchOnRandomMaps, PulledPathsKeepEndsAndClearanceAndAreNeverLonger) {
  const double clearance = map_.options().clearance;
  for (int n = 0; n < 10; ++n) {
    const auto voxels = PathSearch::FindPath(map_, {{Somewhere(), 0}}, Somewhere());
    if (!voxels) continue;
    std::vector<Eigen::Vector3d> path_W;
    for (const VoxelIndex& i : *voxels) path_W.push_back(map_.CenterOf(i));
    const std::vector<Eigen::Vector3d> pulled_W = PullStraight(map_, path_W, clearance);
    EXPECT_EQ(pulled_W.front(), path_W.front());
    EXPECT_EQ(pulled_W.back(), path_W.back());
    EXPECT_LE(PathLength(pulled_W), PathLength(path_W) + 1e-9);
    const double before = test::SampledClearance(map_, path_W, Obstacles::kOccupiedAndUnknown, 0.3);
    const double after = test::SampledClearance(map_, pulled_W, Obstacles::kOccupiedAndUnknown, 0.3);
    EXPECT_GE(after, std::min(clearance - kSize / 8, before) - 0.001);
  }
}

/// The occupied voxels that a body of that radius touches, with the radius that it may have beside each.
std::map<std::array<int, 3>, double> BruteTouched(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                                  double radius) {
  std::map<std::array<int, 3>, double> touched;
  test::ForEachVoxel(CubeAround(map.IndexOf(p_W), 3), [&](const VoxelIndex& i) {
    if (map.State(i) != VoxelState::kOccupied) return;
    const double gap = test::RadiusBeside(map, p_W, i);
    if (gap < radius) touched[{i.x, i.y, i.z}] = gap;
  });
  return touched;
}

/// Whether a straight way touches nothing that is not touched where it begins, and comes no nearer to that
/// than to the nearest of it, by points 2 mm apart. @param more  [m] By which the body is larger on its way,
/// or smaller.
bool LeavesWhatItTouches(const PlanningMap& map, const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W,
                         double radius, double more) {
  const auto before = BruteTouched(map, a_W, radius);
  const double away = more > 0.0 ? 5e-5 : more;  // or it might come nearer before the first of the points
  double least = radius;
  for (const auto& [voxel, gap] : before) least = std::min(least, gap);
  return ForEachPointAlong(a_W, b_W, 0.002, [&](const Eigen::Vector3d& p_W) {
    const auto now = BruteTouched(map, p_W, radius + more);
    return std::ranges::all_of(
        now, [&](const auto& its) { return before.contains(its.first) && its.second >= least + away; });
  });
}

TEST_P(PathSearchOnRandomMaps, EntriesAreExactlyThePlacesThatTheRobotMayLeaveFor) {
  constexpr double kBodyRadius = 0.12;
  constexpr double kReach = 0.3;
  int shut_in = 0;
  for (int n = 0; n < 60; ++n) {
    const Eigen::Vector3d p_W =
        test::RandomPoint(random_, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1.8, 1.8, 1.4)});
    if (map_.State(map_.IndexOf(p_W)) != VoxelState::kFree) continue;
    std::set<std::array<int, 3>> entries;
    const PathSearch::Start start = PathSearch::StartAt(map_, p_W, kBodyRadius, {kReach});
    for (const auto& [i, cost] : start) {
      const Eigen::Vector3d center = map_.CenterOf(i);
      entries.insert({i.x, i.y, i.z});
      EXPECT_TRUE(map_.Traversable(i));
      EXPECT_TRUE(map_.InSight(p_W, center));
      EXPECT_TRUE(LeavesWhatItTouches(map_, p_W, center, kBodyRadius, -0.002));
      if (i == map_.IndexOf(p_W) && start.size() == 1) continue;
      EXPECT_LE((center - p_W).norm(), kReach);
      EXPECT_NEAR(cost, 100.0 * (center - p_W).norm() / kSize, 0.51);
    }
    shut_in += start.empty() ? 1 : 0;
    if (start.size() == 1 && start.front().voxel == map_.IndexOf(p_W) && start.front().cost == 0) continue;
    for (const VoxelIndex& i : traversable_) {
      const Eigen::Vector3d center = map_.CenterOf(i);
      if ((center - p_W).norm() > kReach || !map_.InSight(p_W, center)) continue;
      if (!LeavesWhatItTouches(map_, p_W, center, kBodyRadius, 0.002)) continue;
      EXPECT_TRUE(entries.contains({i.x, i.y, i.z}));
    }
  }
  EXPECT_LT(shut_in, 60);
}

TEST(PathSearch, ARobotAroundWhichTheMapHasADoorLeavesItByALongLine) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{-20, -20, -20}, {20, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{-20, 0, -20}, {20, 2, 20}}, VoxelState::kOccupied));
  // In a voxel of the door, off its middle in all axes: a line to the center of a voxel nearby touches others.
  const Eigen::Vector3d p_W(0.025, 0.083, 0.075);
  EXPECT_TRUE(PathSearch::StartAt(map, p_W, 0.1, {0.3}).empty());
  const PathSearch::Start start = PathSearch::StartAt(map, p_W, 0.1, {1.0, true});
  EXPECT_FALSE(start.empty());
  for (const PathSearch::Entry& entry : start)
    EXPECT_LT(map.CenterOf(entry.voxel).y(), -0.1) << "not through it";
}

TEST(PathSearch, ARobotTooNearToAWallLeavesItWithoutComingNearer) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, -10, -10}, {10, 10, 10}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{-1, -10, -10}, {0, 10, 10}}, VoxelState::kOccupied));
  const Eigen::Vector3d p_W(0.08, 0.03, 0.02);
  const PathSearch::Start start = PathSearch::StartAt(map, p_W, 0.12, {0.3});
  ASSERT_FALSE(start.empty());
  for (const PathSearch::Entry& entry : start) {
    EXPECT_GE(map.CenterOf(entry.voxel).x(), 0.15);
    EXPECT_GT(entry.cost, 0U);
  }
}

TEST(PathSearch, ARobotThatDrivesLeavesWhatItsCameraLooksOver) {
  // Nothing is known within 0.8 m of it, except above 0.6 m, where its camera is.
  for (const double camera_height : {0.0, 0.5}) {
    PlanningMap map({.voxel_size = 0.1,
                     .clearance = 0.15,
                     .half_height = 0.2,
                     .bounds = {},
                     .camera_height = camera_height});
    map.Apply(test::BoxOf({{0, 0, 0}, {40, 40, 12}}, VoxelState::kFree));
    map.Apply(test::BoxOf({{12, 12, 0}, {28, 28, 6}}, VoxelState::kUnknown));
    map.SetPlane(0.35);
    EXPECT_EQ(PathSearch::StartAt(map, {2.0, 2.0, 0.35}, 0.12, {1.3}).empty(), camera_height == 0.0);
    for (const VoxelBox& side : {VoxelBox{{15, 15, 1}, {16, 25, 2}},
                                 {{24, 15, 1}, {25, 25, 2}},
                                 {{15, 15, 1}, {25, 16, 2}},
                                 {{15, 24, 1}, {25, 25, 2}}})
      map.Apply(test::BoxOf(side, VoxelState::kOccupied));
    EXPECT_TRUE(PathSearch::StartAt(map, {2.0, 2.0, 0.35}, 0.12, {1.3}).empty()) << "it would touch that";
  }
}

/// Two rooms, of which the one at x < 2 m is larger, connected by a gap of 0.3 m. The center of a voxel in
/// the gap has 0.15 m of clearance: enough for the robot's radius, but less than the clearance it needs.
PlanningMap RoomsWithANarrowGap() {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.17, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {30, 12, 12}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{20, 0, 0}, {22, 12, 12}}, VoxelState::kOccupied));
  map.Apply(test::BoxOf({{20, 5, 5}, {22, 8, 8}}, VoxelState::kFree));
  return map;
}

bool InSmallRoom(const PathSearch::Entry& entry) {
  return entry.voxel.x >= 22;
}

TEST(PathSearch, OutOfATightPlaceTheLargestPartComesFirst) {
  const PlanningMap map = RoomsWithANarrowGap();
  const Eigen::Vector3d between_W(2.1, 0.65, 0.65);
  const PathSearch::Start start = PathSearch::StartAt(map, between_W, 0.12, {1.0});
  const std::vector<PathSearch::Start> parts = PathSearch::Parts(map, start);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_TRUE(std::ranges::none_of(parts[0], InSmallRoom));
  EXPECT_TRUE(std::ranges::all_of(parts[1], InSmallRoom));
  EXPECT_EQ(parts[0].size() + parts[1].size(), start.size());
}

TEST(PathSearch, OutOfAPocketItMayGoThroughWhatIsOnlyTight) {
  PlanningMap map = RoomsWithANarrowGap();
  const Eigen::Vector3d p_W(2.45, 0.65, 0.65);
  ASSERT_TRUE(map.Traversable(map.IndexOf(p_W)));
  EXPECT_EQ(PathSearch::StartAt(map, p_W, 0.12, {1.0}).size(), 1U);
  const PathSearch::Start best =
      PathSearch::Parts(map, PathSearch::StartAt(map, p_W, 0.12, {1.0, true})).front();
  ASSERT_FALSE(best.empty());
  EXPECT_TRUE(std::ranges::none_of(best, InSmallRoom));
  for (const PathSearch::Entry& entry : best) {
    EXPECT_TRUE(map.SegmentClear(p_W, map.CenterOf(entry.voxel), Obstacles::kOccupiedAndUnknown, 0.12));
  }
  const PathSearch::Start too_wide = PathSearch::StartAt(map, p_W, 0.16, {1.0, true});
  EXPECT_GT(too_wide.size(), 1U);
  EXPECT_TRUE(std::ranges::all_of(too_wide, InSmallRoom)) << "the gap is too narrow for that one";
  // Unknown space beside the gap blocks it as well.
  map.Apply(test::BoxOf({{20, 5, 5}, {22, 6, 8}}, VoxelState::kUnknown));
  EXPECT_TRUE(std::ranges::all_of(PathSearch::StartAt(map, p_W, 0.12, {1.0, true}), InSmallRoom));
}

TEST(PathSearch, ARobotNeverLeavesThroughAWall) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{-20, -20, -20}, {20, 20, 20}}, VoxelState::kFree));
  map.Apply(test::BoxOf({{0, -20, -20}, {1, 20, 20}}, VoxelState::kOccupied));
  // On the left side, free space is too narrow to stand in.
  map.Apply(test::BoxOf({{-3, -20, -20}, {-2, 20, 20}}, VoxelState::kOccupied));
  EXPECT_TRUE(PathSearch::StartAt(map, {-0.1, 0.0, 0.0}, 0.12, {1.0}).empty());
  EXPECT_FALSE(PathSearch::StartAt(map, {0.2, 0.0, 0.0}, 0.12, {1.0}).empty());
}

}  // namespace
}  // namespace thalweg::explorer
