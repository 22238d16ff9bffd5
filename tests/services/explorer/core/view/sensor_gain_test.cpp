#include "services/explorer/core/view/sensor_gain.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "common/geometry/robot_model.h"
#include "common/geometry/spread_directions.h"
#include "common/voxel/ray.h"
#include "services/explorer/core/map/frontier.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

constexpr double kSize = 0.1;
constexpr double kRange = 1.2;  // [m] much less than the length of the scenes

/// The gain of each view from a place with every ray cast again; weights in sixteenths, as the class keeps
/// them.
std::vector<double> BruteGains(const PlanningMap& map, const ViewPlanner& views, const VoxelIndex& place,
                               const std::set<std::size_t>& targets,
                               const std::set<std::size_t>& doubtful = {}) {
  std::vector<double> gains(views.candidates().size(), 0.0);
  std::set<std::size_t> counted;
  // From voxel 0, so that rounding is the same for every place.
  const VoxelIndex origin{0, 0, 0};
  const Eigen::Vector3d from = VoxelCenter(origin, kSize);
  for (const Eigen::Vector3d& direction_W : SpreadDirections(SensorGain::kRays)) {
    TraverseVoxels(from, from + kRange * direction_W, kSize, [&](const VoxelIndex& step) {
      const VoxelIndex i = place + step;
      if (i == place) return true;
      const bool goes_on = map.State(i) == VoxelState::kFree;
      const std::size_t offset = map.states().Offset(i);
      const bool faint = doubtful.contains(offset);
      const bool counts = faint || (!goes_on && targets.contains(offset));
      if (!counts || !counted.insert(offset).second) return goes_on;
      const double r = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
      double weight = std::round(16.0 * std::max(1.0, r * r * 4.0 * std::numbers::pi / SensorGain::kRays));
      if (faint) weight = std::round(map.options().doubt.weight * weight);
      for (std::size_t n = 0; n < gains.size(); ++n) {
        if (views.Shows(views.candidates()[n], {.voxel = i, .offset_W = direction_W}))
          gains[n] += weight / 16.0;
      }
      return goes_on;
    });
  }
  return gains;
}

class SensorGains : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, SensorGains, testing::Range(1U, 7U));

TEST_P(SensorGains, EqualBruteForceAfterEveryChangeOfTheMap) {
  std::mt19937 random(GetParam());
  PlanningMap map({.voxel_size = kSize, .clearance = 0.1, .bounds = {}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {50, 18, 12}}, 30, 7));
  const ViewPlanner views(DepthSensorModel{}.camera, RobotModel{});
  SensorGain gain(views, kSize, kRange);
  for (int round = 0; round < 8; ++round) {
    // Boxes become free, occupied or, as in a map that is rebuilt, unknown; one makes the map grow.
    const VoxelIndex low = test::RandomVoxel(random, {{0, 0, 0}, {54, 18, 12}});
    const VoxelIndex high = low + VoxelIndex{test::RandomInt(random, 1, 5), test::RandomInt(random, 1, 5),
                                             test::RandomInt(random, 1, 5)};
    map.Apply(test::BoxOf({low, high}, static_cast<VoxelState>(random() % 3)));
    if (round == 4) map.Apply(test::BoxOf({{-40, 3, 3}, {2, 9, 9}}, VoxelState::kFree));
    if (round == 6) map.Apply(test::BoxOf({{8, 2, 2}, {20, 12, 11}}, VoxelState::kOccupied));
    std::vector<VoxelIndex> targets;
    std::set<std::size_t> offsets;
    test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
      // Most targets stay the same.
      if (!IsTarget(map, i) || (i.x / 10 == round && random() % 3 == 0)) return;
      targets.push_back(i);
      offsets.insert(map.states().Offset(i));
    });
    gain.Follow(map, targets);
    SensorGain fresh(views, kSize, kRange);
    fresh.Follow(map, targets);
    for (const VoxelIndex& place : test::TraversableVoxels(map)) {
      if ((place.x + 3 * place.y + 5 * place.z) % 31 != 0) continue;
      const std::vector<double> expected = BruteGains(map, views, place, offsets);
      const double best = *std::max_element(expected.begin(), expected.end());
      EXPECT_EQ(gain.UpperBound(place), fresh.UpperBound(place));
      EXPECT_GE(gain.UpperBound(place), best);
      const SensorGain::Gain found = gain.BestView(place);
      EXPECT_EQ(found.value, best);
      EXPECT_EQ(found.value, expected[found.view]);
      std::set<std::size_t> seen;
      for (const VoxelIndex& i : found.seen) {
        EXPECT_TRUE(offsets.contains(map.states().Offset(i)));
        EXPECT_TRUE(seen.insert(map.states().Offset(i)).second);
      }
      EXPECT_EQ(seen.empty(), best == 0.0);
    }
  }
}

TEST_P(SensorGains, DoubtfulVoxelsCountByTheirWeightWhetherRaysPassThemOrNot) {
  std::mt19937 random(GetParam());
  PlanningMap map(
      {.voxel_size = kSize, .clearance = 0.1, .bounds = {}, .doubt = {.max_log_odds = 0.5, .weight = 0.3}});
  map.Apply(test::RandomScene(random, {{0, 0, 0}, {40, 16, 12}}, 24, 7));
  const ViewPlanner views(DepthSensorModel{}.camera, RobotModel{});
  SensorGain gain(views, kSize, kRange);
  int passed = 0;
  for (int round = 0; round < 4; ++round) {
    for (int n = 0; n < 150; ++n) {  // some become doubtful, some certain, some the opposite
      const VoxelIndex i = test::RandomVoxel(random, {{0, 0, 0}, {40, 16, 12}});
      if (map.State(i) == VoxelState::kUnknown) continue;
      const VoxelChange change{i, static_cast<float>(test::RandomDouble(random, -1.0, 1.0))};
      map.Apply({&change, 1});
    }
    std::vector<VoxelIndex> targets;
    std::vector<VoxelIndex> doubtful;
    std::set<std::size_t> target_offsets;
    std::set<std::size_t> doubtful_offsets;
    test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
      if (!IsTarget(map, i)) return;
      (map.Doubtful(i) ? doubtful : targets).push_back(i);
      (map.Doubtful(i) ? doubtful_offsets : target_offsets).insert(map.states().Offset(i));
    });
    ASSERT_GT(doubtful.size(), 20U);
    gain.Follow(map, targets, doubtful);
    for (const VoxelIndex& place : test::TraversableVoxels(map)) {
      if ((place.x + 3 * place.y + 5 * place.z) % 31 != 0) continue;
      const std::vector<double> expected = BruteGains(map, views, place, target_offsets, doubtful_offsets);
      const double best = *std::max_element(expected.begin(), expected.end());
      EXPECT_GE(gain.UpperBound(place), best);
      const SensorGain::Gain found = gain.BestView(place);
      EXPECT_EQ(found.value, best);
      for (const VoxelIndex& i : found.seen) {
        EXPECT_TRUE(map.Doubtful(i) || target_offsets.contains(map.states().Offset(i)));
        passed += map.Doubtful(i) && map.State(i) == VoxelState::kFree ? 1 : 0;
      }
    }
  }
  EXPECT_GT(passed, 100);
  gain.Follow(map, {});
  EXPECT_EQ(gain.UpperBound(test::TraversableVoxels(map).front()), 0.0);
}

}  // namespace
}  // namespace thalweg::explorer
