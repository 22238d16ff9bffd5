#include "services/explorer/core/strategy/potential_thesis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "services/explorer/core/map/free_frontier.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

using test::kClearance;
using test::kViews;

class PotentialThesisTest : public testing::Test {
 protected:
  std::vector<Candidate> Find(double min_area = 0.0) {
    aside_ = DenseGrid<std::uint8_t>(map_.box(), 0);
    return *strategy_.FindCandidates({.map = map_,
                                      .robot_W = robot_W_,
                                      .clearance = kClearance,
                                      .set_aside = aside_,
                                      .min_area = min_area});
  }
  Choice ChooseAmong(const std::vector<Candidate>& candidates) {
    return strategy_.Choose({map_, search_, robot_W_, kClearance, candidates, kViews, 3.0, 3.0, false});
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  DenseGrid<std::uint8_t> aside_;
  Eigen::Vector3d robot_W_{0.05, 0.05, 0.05};
  PotentialThesis strategy_{{}};
};

/// A corridor of 12 x 0.7 x 0.7 m along x with walls all around, and unknown at both ends.
std::vector<VoxelChange> Corridor() {
  std::vector<VoxelChange> changes = test::BoxOf({{-60, -4, -4}, {60, 5, 5}}, VoxelState::kOccupied);
  test::Fill(changes, {{-60, -3, -3}, {60, 4, 4}}, VoxelState::kFree);
  return changes;
}

TEST_F(PotentialThesisTest, FlowsToTheNearerEndOfACorridorAndStaysOnTheLine) {
  map_.Apply(Corridor());
  robot_W_.x() = -2.95;
  const std::vector<Candidate> candidates = Find();
  ASSERT_EQ(candidates.size(), 2U);
  const Choice choice = ChooseAmong(candidates);
  ASSERT_GT(choice.path_W.size(), 2U);
  EXPECT_EQ(choice.path_W.front(), robot_W_);
  EXPECT_EQ(map_.IndexOf(choice.path_W.back()), (VoxelIndex{-60, 0, 0})) << "in the frontier voxel itself";
  EXPECT_EQ(choice.target, (std::vector<VoxelIndex>{{-61, 0, 0}}));
  EXPECT_EQ(candidates[choice.candidate].goals.front().x, -60);
}

TEST_F(PotentialThesisTest, ItsFrontiersAreTheFreeOnesWhereTheBodyTouchesNoObstacle) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    map_.Reset();
    map_.Apply(test::RandomScene(random, {{0, 0, 0}, {24, 22, 14}}, 14, 7));
    std::set<std::tuple<int, int, int>> goals;
    std::set<std::tuple<int, int, int>> unknowns;
    PotentialThesis::Options options;
    options.connected_only = false;
    strategy_ = PotentialThesis(options);
    for (const Candidate& candidate : Find()) {
      EXPECT_FALSE(candidate.cluster.unknowns.empty());
      for (const VoxelIndex& i : candidate.goals) EXPECT_TRUE(goals.insert({i.x, i.y, i.z}).second);
      for (const VoxelIndex& i : candidate.cluster.unknowns) unknowns.insert({i.x, i.y, i.z});
    }
    std::size_t expected = 0;
    for (const VoxelIndex& i : FreeFrontier(map_, aside_)) {
      const double gap =
          test::BruteClearance(map_, map_.CenterOf(i), PlanningMap::Obstacles::kOccupied, kClearance);
      if (gap < kClearance - 1e-6 || i == map_.IndexOf(robot_W_)) continue;
      ++expected;
      EXPECT_TRUE(goals.contains({i.x, i.y, i.z}));
    }
    EXPECT_EQ(goals.size(), expected);
    for (const auto& [x, y, z] : unknowns) EXPECT_EQ(map_.State({x, y, z}), VoxelState::kUnknown);
    EXPECT_GT(expected, 50U);
  }
}

TEST_F(PotentialThesisTest, DropsComponentsBelowTheLeastArea) {
  map_.Apply(Corridor());
  map_.Apply(test::BoxOf({{20, 0, 0}, {21, 1, 1}}, VoxelState::kUnknown));
  EXPECT_EQ(Find().size(), 3U) << "the speck has six free neighbors";
  EXPECT_EQ(Find(0.065).size(), 2U);
}

TEST_F(PotentialThesisTest, AClosedRoomHasNoFrontier) {
  std::vector<VoxelChange> room = test::BoxOf({{-9, -9, -9}, {10, 10, 10}}, VoxelState::kOccupied);
  test::Fill(room, {{-8, -8, -8}, {9, 9, 9}}, VoxelState::kFree);
  map_.Apply(room);
  EXPECT_TRUE(Find().empty());
}

TEST_F(PotentialThesisTest, AFrontierBehindAWallCountsOnlyAsPrinted) {
  map_.Apply(Corridor());
  map_.Apply(test::BoxOf({{-20, -4, -4}, {-19, 5, 5}}, VoxelState::kOccupied));
  map_.Apply(test::BoxOf({{20, -4, -4}, {21, 5, 5}}, VoxelState::kOccupied));
  EXPECT_TRUE(Find().empty());
  PotentialThesis::Options as_printed;
  as_printed.connected_only = false;
  strategy_ = PotentialThesis(as_printed);
  const std::vector<Candidate> candidates = Find();
  ASSERT_EQ(candidates.size(), 2U);
  // phi grew from 0 toward 1 everywhere; where the sweeps stopped, it still falls with the distance.
  const Choice choice = ChooseAmong(candidates);
  ASSERT_GT(choice.path_W.size(), 2U);
  EXPECT_GT(std::abs(choice.path_W.back().x()), 1.5) << "so the robot goes to the wall, and back from there";
  EXPECT_LT(std::abs(choice.path_W.back().x()), 2.0);
  EXPECT_TRUE(choice.target.empty());
}

using ThesisToPlaces = test::OnRandomMaps;
INSTANTIATE_TEST_SUITE_P(Seeds, ThesisToPlaces, testing::Range(1U, 11U));

TEST_P(ThesisToPlaces, EndsInAPlaceOfTheCandidateThatItNames) {
  for (const auto domain :
       {PotentialThesis::Options::Domain::kFree, PotentialThesis::Options::Domain::kReachable}) {
    PotentialThesis strategy({.sinks = PotentialThesis::Options::Sinks::kViewingPlaces,
                              .domain = domain,
                              .relaxation = {},
                              .descent = {}});
    const DenseGrid<std::uint8_t> aside(map_.box(), 0);
    EXPECT_FALSE(strategy.FindCandidates(
        {.map = map_, .robot_W = robot_W_, .clearance = kClearance, .set_aside = aside, .min_area = 0.0}))
        << "they are those of all other strategies";
    const Choice choice = strategy.Choose(situation());
    EXPECT_EQ(choice.path_W.front(), robot_W_);
    EXPECT_TRUE(choice.target.empty());
    const std::vector<VoxelIndex>& goals = candidates_[choice.candidate].goals;
    EXPECT_EQ(std::ranges::count(goals, map_.IndexOf(choice.path_W.back())), 1);
    // Where the domain ends phi is that of a wall.
    std::size_t outside = 0;
    for (std::size_t k = 0; k < strategy.field()->size(); ++k) {
      const VoxelIndex i = strategy.field()->IndexAt(k);
      if (search_.Reached(i) || std::isnan((*strategy.field())[k])) continue;
      ++outside;
    }
    EXPECT_EQ(outside > 0, domain == PotentialThesis::Options::Domain::kFree);
  }
}

TEST_P(ThesisToPlaces, TakesAPlaceWhereItStandsAtOnce) {
  candidates_.push_back(test::CandidateAt({map_.IndexOf(robot_W_)}, search_));
  PotentialThesis strategy(
      {.sinks = PotentialThesis::Options::Sinks::kViewingPlaces, .relaxation = {}, .descent = {}});
  EXPECT_EQ(strategy.Choose(situation()).candidate, candidates_.size() - 1);
}

// The sweeps stop early, so the fields differ; where they are steep the line is the same.
TEST_F(PotentialThesisTest, SolvedItGoesToTheSameEndOfACorridor) {
  map_.Apply(Corridor());
  robot_W_.x() = -2.95;
  PotentialThesis solved(
      {.solve = true, .relaxation = {.walls = RelaxationOptions::Walls::kDropped}, .descent = {}});
  const std::vector<Candidate> candidates = Find();
  const Choice choice =
      solved.Choose({map_, search_, robot_W_, kClearance, candidates, kViews, 3.0, 3.0, false});
  ASSERT_FALSE(choice.path_W.empty());
  EXPECT_EQ(map_.IndexOf(choice.path_W.back()), (VoxelIndex{-60, 0, 0}));
  // Far from the robot the flow fills the corridor, so phi is straight; what the sweeps leave is not.
  const DenseGrid<float>& phi = *solved.field();
  for (int x = -10; x < 58; ++x)
    EXPECT_NEAR(phi[VoxelIndex(x, 0, 0)] - phi[VoxelIndex(x - 1, 0, 0)],
                phi[VoxelIndex(58, 0, 0)] - phi[VoxelIndex(57, 0, 0)], 1e-4);
}

TEST_F(PotentialThesisTest, OptionsThatMakeNoSenseAreRefused) {
  PotentialThesis::Options options;
  options.relaxation.largest_change = 0.0;
  EXPECT_THROW(PotentialThesis{options}, std::invalid_argument);
  options = {};
  options.descent.step_cells = -1.0;
  EXPECT_THROW(PotentialThesis{options}, std::invalid_argument);
  options = {};
  options.domain = PotentialThesis::Options::Domain::kReachable;
  EXPECT_THROW(PotentialThesis{options}, std::invalid_argument);
  options = {};
  options.solve = true;
  EXPECT_THROW(PotentialThesis{options}, std::invalid_argument) << "walls are mirrored";
  options.relaxation.walls = RelaxationOptions::Walls::kDropped;
  EXPECT_NO_THROW(PotentialThesis{options});
  options.connected_only = false;
  EXPECT_THROW(PotentialThesis{options}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
