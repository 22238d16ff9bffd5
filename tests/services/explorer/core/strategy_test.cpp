#include "services/explorer/core/strategy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "tests/services/explorer/core/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

constexpr double kSize = 0.1;
constexpr double kClearance = 0.15;

TEST(Strategies, AnUnknownNameIsRefusedWithTheNamesThereAre) {
  try {
    MakeStrategy({.name = "furthest"});
    FAIL() << "was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("furthest"));
    EXPECT_THAT(error.what(), testing::HasSubstr("closest, potential"));
  }
}

Candidate CandidateAt(std::vector<VoxelIndex> goals, const PathSearch& search) {
  Candidate candidate;
  candidate.cluster.center_W = Eigen::Vector3d::Zero();
  candidate.length = search.Length(goals.front());
  candidate.goals = std::move(goals);
  return candidate;
}

/// A random map, a robot at a random place in it, candidates at random places that it can reach.
class StrategiesOnRandomMaps : public testing::TestWithParam<unsigned> {
 protected:
  StrategiesOnRandomMaps() {
    map_.Apply(test::RandomScene(random_, {{0, 0, 0}, {34, 30, 22}}, 22, 8));
    const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map_);
    do {
      const VoxelIndex& start = traversable[random_() % traversable.size()];
      robot_W_ = map_.CenterOf(start);
      search_.Flood(map_, {{start, 0}});
    } while (2 * search_.reached_count() < traversable.size());
    std::vector<VoxelIndex> reached;
    for (const VoxelIndex& i : traversable) {
      if (search_.Reached(i)) reached.push_back(i);
    }
    for (int n = 0; n < 5; ++n) {
      std::vector<VoxelIndex> goals = {reached[random_() % reached.size()]};
      for (const VoxelIndex& offset : kFaceNeighbours) {
        const VoxelIndex beside = goals.front() + offset;
        if (search_.Reached(beside) && search_.Cost(beside) >= search_.Cost(goals.front())) {
          goals.push_back(beside);
        }
      }
      candidates_.push_back(CandidateAt(std::move(goals), search_));
    }
  }

  Situation situation() const { return {map_, search_, robot_W_, kClearance, candidates_}; }
  std::size_t Nearest() const {
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < candidates_.size(); ++n) {
      if (candidates_[n].length < candidates_[nearest].length) nearest = n;
    }
    return nearest;
  }
  void ExpectGoodPath(const Choice& choice) const {
    EXPECT_EQ(choice.path_W.front(), robot_W_);
    EXPECT_LT((choice.path_W.back() - map_.CenterOf(candidates_[choice.candidate].goals.front())).norm(),
              1e-9);
    for (std::size_t n = 1; n < choice.path_W.size(); ++n) {
      EXPECT_TRUE(map_.InSight(choice.path_W[n - 1], choice.path_W[n]));
    }
    // A diagonal step past an edge is nearer to it in its middle, pulling straight looks no closer than an
    // eighth of a voxel.
    EXPECT_GE(test::SampledClearance(map_, choice.path_W, Obstacles::kOccupiedAndUnknown, 0.3),
              kClearance - kSize / 8 - 0.001);
  }

  std::mt19937 random_{GetParam()};
  PlanningMap map_{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  Eigen::Vector3d robot_W_;
  std::vector<Candidate> candidates_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, StrategiesOnRandomMaps, testing::Range(1U, 21U));

TEST_P(StrategiesOnRandomMaps, ClosestTakesTheShortestWay) {
  const Choice choice = MakeStrategy({.name = "closest"})->Choose(situation());
  EXPECT_EQ(choice.candidate, Nearest());
  // Costs are hundredths, cut off: a diagonal step counts 1.41 voxels.
  EXPECT_LE(PathLength(choice.path_W), 1.004 * candidates_[choice.candidate].length + 1e-9);
  ExpectGoodPath(choice);
}

TEST_P(StrategiesOnRandomMaps, PotentialKeepsToFreeSpaceAndItsClearance) {
  for (const double screening : {0.0, 0.6}) {
    ExpectGoodPath(MakeStrategy({.name = "potential", .screening_length = screening})->Choose(situation()));
  }
}

TEST_P(StrategiesOnRandomMaps, PotentialTakesWhatIsAtHandAtOnce) {
  StrategyOptions options{.name = "potential"};
  options.source_radius = candidates_[Nearest()].length + 0.01;
  const Choice choice = MakeStrategy(options)->Choose(situation());
  EXPECT_EQ(choice.candidate, Nearest());
  EXPECT_EQ(choice.field_ms, 0.0);
}

/// A straight corridor with the robot in it and a candidate on each side.
class Corridor : public testing::Test {
 protected:
  Corridor() { map_.Apply(test::BoxOf({{-60, -3, -3}, {60, 4, 4}}, VoxelState::kFree)); }

  Choice ChooseAmong(const std::vector<std::vector<VoxelIndex>>& goals) {
    search_.Flood(map_, {{{0, 0, 0}, 0}});
    candidates_.clear();
    for (const std::vector<VoxelIndex>& of_one : goals) {
      candidates_.push_back(CandidateAt(of_one, search_));
    }
    return MakeStrategy({.name = "potential"})
        ->Choose({map_, search_, map_.CenterOf({0, 0, 0}), kClearance, candidates_});
  }

  PlanningMap map_{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  std::vector<Candidate> candidates_;
};

TEST_F(Corridor, OfTwoEqualCandidatesPotentialTakesTheNearer) {
  EXPECT_EQ(ChooseAmong({{{-40, 0, 0}}, {{20, 0, 0}}}).candidate, 1U);
  EXPECT_EQ(ChooseAmong({{{-20, 0, 0}}, {{40, 0, 0}}}).candidate, 0U);
}

TEST_F(Corridor, OfTwoAtTheSameDistancePotentialTakesTheWider) {
  std::vector<VoxelIndex> across;
  test::ForEachVoxel({{30, -1, -1}, {31, 2, 2}}, [&](const VoxelIndex& i) {
    if (map_.Traversable(i)) across.push_back(i);
  });
  std::iter_swap(across.begin(), std::find(across.begin(), across.end(), VoxelIndex{30, 0, 0}));
  ASSERT_GT(across.size(), 4U);
  EXPECT_EQ(ChooseAmong({{{-30, 0, 0}}, across}).candidate, 1U);
}

TEST_F(Corridor, WhatAnotherCandidateHidesFromTheFlowIsNotChosen) {
  std::vector<VoxelIndex> across;
  test::ForEachVoxel({{15, -3, -3}, {16, 4, 4}}, [&](const VoxelIndex& i) {
    if (map_.Traversable(i)) across.push_back(i);
  });
  std::iter_swap(across.begin(), std::find(across.begin(), across.end(), VoxelIndex{15, 0, 0}));
  EXPECT_EQ(ChooseAmong({{{16, 0, 0}, {17, 0, 0}, {18, 0, 0}}, across}).candidate, 1U);
}

}  // namespace
}  // namespace thalweg::explorer
