#include "services/explorer/core/strategy/strategy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/geometry/robot_model.h"
#include "services/explorer/core/strategy/cover.h"
#include "services/explorer/core/strategy/flow.h"
#include "services/explorer/core/strategy/information_gain.h"
#include "services/explorer/core/strategy/potential.h"
#include "services/explorer/core/strategy/random.h"
#include "services/explorer/core/strategy/registry.h"
#include "services/explorer/core/strategy/viewpoints.h"
#include "services/explorer/core/view/goal_finder.h"
#include "services/explorer/core/view/sensor_gain.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

constexpr double kSize = 0.1;
constexpr double kClearance = 0.15;
constexpr double kSensorRange = 3.0;
constexpr double kLookRange = 3.0;
const ViewPlanner kViews(DepthSensorModel{}.camera, RobotModel{}.T_BC.linear());

std::unique_ptr<Strategy> Make(const std::string& name) {
  return Configure(name).make();
}

TEST(Strategies, APathThatDoesNotLeadToTheClusterIsRefused) {
  Potential::Options options;
  options.cluster = Potential::Options::Cluster::kFlux;
  EXPECT_THROW(Potential{options}, std::invalid_argument);
  options.path = Potential::Options::Path::kShortest;
  EXPECT_NO_THROW(Potential{options});
}

Candidate CandidateAt(std::vector<VoxelIndex> goals, const PathSearch& search) {
  Candidate candidate;
  candidate.cluster.center_W = Eigen::Vector3d::Zero();
  candidate.length = search.Length(goals.front());
  candidate.goals = std::move(goals);
  return candidate;
}

/// A random map, a robot at a random position in it, and candidates at random positions that it can reach.
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
      for (const VoxelIndex& offset : kFaceNeighbors) {
        const VoxelIndex beside = goals.front() + offset;
        if (search_.Reached(beside) && search_.Cost(beside) >= search_.Cost(goals.front())) {
          goals.push_back(beside);
        }
      }
      candidates_.push_back(CandidateAt(std::move(goals), search_));
    }
  }

  Situation situation() const {
    return {map_, search_, robot_W_, kClearance, candidates_, kViews, kSensorRange, kLookRange};
  }
  std::size_t Nearest() const {
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < candidates_.size(); ++n) {
      if (candidates_[n].length < candidates_[nearest].length) nearest = n;
    }
    return nearest;
  }
  void ExpectGoodPath(const Choice& choice) const {
    EXPECT_EQ(choice.path_W.front(), robot_W_);
    for (std::size_t n = 1; n < choice.path_W.size(); ++n) {
      EXPECT_TRUE(map_.InSight(choice.path_W[n - 1], choice.path_W[n]));
    }
    // A diagonal step past an edge is nearest to it in its middle, and straightening resolves an eighth of a
    // voxel.
    EXPECT_GE(test::SampledClearance(map_, choice.path_W, Obstacles::kOccupiedAndUnknown, 0.3),
              kClearance - kSize / 8 - 0.001);
  }
  void ExpectEndsAtTheCandidate(const Choice& choice) const {
    const std::vector<VoxelIndex>& goals = candidates_[choice.candidate].goals;
    const VoxelIndex end = map_.IndexOf(choice.path_W.back());
    EXPECT_TRUE(std::find(goals.begin(), goals.end(), end) != goals.end());
    EXPECT_LT((choice.path_W.back() - map_.CenterOf(end)).norm(), 1e-9);
  }
  /// The map's own frontier clusters, as candidates at the positions from which they are in sight.
  void TakeFrontiers() {
    candidates_.clear();
    const DenseGrid<std::uint8_t> none(map_.box(), 0);
    for (const Cluster& cluster : FindFrontiers(map_, none, {}).clusters) {
      Candidate candidate{.cluster = cluster, .goals = {map_.IndexOf(robot_W_)}, .length = 1e6};
      candidates_.push_back(std::move(candidate));
    }
  }

  std::mt19937 random_{GetParam()};
  PlanningMap map_{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  Eigen::Vector3d robot_W_;
  std::vector<Candidate> candidates_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, StrategiesOnRandomMaps, testing::Range(1U, 21U));

TEST_P(StrategiesOnRandomMaps, ClosestTakesTheShortestPath) {
  const Choice choice = Make("closest")->Choose(situation());
  EXPECT_EQ(choice.candidate, Nearest());
  // Costs are truncated to hundredths: a diagonal step counts 1.41 voxels.
  EXPECT_LE(PathLength(choice.path_W), 1.004 * candidates_[choice.candidate].length + 1e-9);
  ExpectGoodPath(choice);
  ExpectEndsAtTheCandidate(choice);
}

TEST_P(StrategiesOnRandomMaps, ATurnCountsAsThePathThatItCosts) {
  const std::size_t nearest = Nearest();
  candidates_[nearest].turn = 1000.0;
  EXPECT_NE(Make("closest")->Choose(situation()).candidate, nearest);
  for (Candidate& candidate : candidates_) candidate.turn = 1000.0;
  EXPECT_EQ(Make("closest")->Choose(situation()).candidate, nearest);
}

TEST_P(StrategiesOnRandomMaps, FlowKeepsToFreeSpaceAndIsTheSameEachTime) {
  for (const double eagerness : {0.0, 1.0}) {
    Flow flow({.eagerness = eagerness});
    Flow again({.eagerness = eagerness});
    for (int n = 0; n < 3; ++n) {
      const Choice choice = flow.Choose(situation());
      ExpectGoodPath(choice);
      const Choice same = again.Choose(situation());
      EXPECT_EQ(same.candidate, choice.candidate);
      EXPECT_EQ(same.path_W, choice.path_W);
    }
  }
}

TEST_P(StrategiesOnRandomMaps, CoverKeepsToFreeSpaceAndIsTheSameEachTime) {
  const DenseGrid<std::uint8_t> none(map_.box(), 0);
  const std::vector<Candidate> unseen = candidates_;  // without unknown voxels
  candidates_.clear();
  for (const Cluster& cluster : FindFrontiers(map_, none, {}).clusters) {
    const GoalFinder finder(kLookRange, kSize);
    std::vector<VoxelIndex> goals = finder.GoalsOf(cluster, map_, search_, kViews);
    if (goals.empty()) continue;
    const double length = search_.Length(goals.front());
    candidates_.push_back({.cluster = cluster, .goals = std::move(goals), .length = length});
  }
  for (int unknown = 0; unknown < 2; ++unknown) {
    if (candidates_.empty()) candidates_ = unseen;
    Cover cover({.least_yield = 0.0});
    Cover again({.least_yield = 0.0});
    for (int n = 0; n < 4; ++n) {
      const Choice choice = cover.Choose(situation());
      ASSERT_LT(choice.candidate, candidates_.size());
      ExpectGoodPath(choice);
      const Choice same = again.Choose(situation());
      EXPECT_EQ(same.candidate, choice.candidate);
      EXPECT_EQ(same.path_W, choice.path_W);
      EXPECT_EQ(same.target, choice.target);
    }
    candidates_.clear();
  }
}

TEST_P(StrategiesOnRandomMaps, ViewpointsSeeThreeQuartersOfWhatTheGoalSees) {
  const DenseGrid<std::uint8_t> none(map_.box(), 0);
  const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map_);
  const auto sees = [&](const VoxelIndex& from, const VoxelIndex& unknown) {
    const Eigen::Vector3d p_W = map_.CenterOf(from);
    const Eigen::Vector3d q_W = map_.CenterOf(unknown);
    return (p_W - q_W).norm() <= kLookRange && kViews.CanShow(q_W - p_W) && map_.InSight(p_W, q_W);
  };
  for (Cluster& cluster : FindFrontiers(map_, none, {}).clusters) {
    // this many are all looked at
    cluster.unknowns.resize(std::min<std::size_t>(cluster.unknowns.size(), 6));
    // Any position that sees some of it may be its goal.
    const auto goal = std::find_if(traversable.begin(), traversable.end(), [&](const VoxelIndex& i) {
      return search_.Reached(i) && sees(i, cluster.unknowns.front());
    });
    if (goal == traversable.end()) continue;
    const auto seen_from = [&](const VoxelIndex& place) {
      return std::count_if(cluster.unknowns.begin(), cluster.unknowns.end(),
                           [&](const VoxelIndex& i) { return sees(*goal, i) && sees(place, i); });
    };
    candidates_ = {{.cluster = cluster, .goals = {*goal}, .length = search_.Length(*goal)}};
    const Situation here = situation();
    Viewpoints viewpoints(here);
    for (std::size_t n = 0; n < traversable.size(); n += 17) {
      EXPECT_EQ(viewpoints.SeesEnough(traversable[n], 0),
                4 * seen_from(traversable[n]) >= 3 * seen_from(*goal));
    }
    const std::vector<VoxelIndex> places = viewpoints.PlacesFor(
        0, viewpoints.PlacesBefore(0), [&](const VoxelIndex& i) { return search_.Cost(i); });
    EXPECT_EQ(places.front(), *goal);
    for (std::size_t n = 1; n < places.size(); ++n) {
      EXPECT_TRUE(search_.Reached(places[n]));
      EXPECT_GE(4 * seen_from(places[n]), 3 * seen_from(*goal));
      if (n > 1) {
        EXPECT_GE(search_.Cost(places[n]), search_.Cost(places[n - 1]));
      }
    }
  }
}

TEST_P(StrategiesOnRandomMaps, SizeBonusTakesTheLargerOfTwoAtTheSameDistance) {
  TakeFrontiers();
  const Choice choice = Make("size_bonus")->Choose(situation());
  const std::size_t size = candidates_[choice.candidate].cluster.unknowns.size();
  for (const Candidate& candidate : candidates_) {
    EXPECT_LE(std::min<std::size_t>(200, candidate.cluster.unknowns.size()), size);
  }
  ExpectGoodPath(choice);
}

TEST_P(StrategiesOnRandomMaps, EveryKindOfPotentialKeepsToFreeSpaceAndItsClearance) {
  using Cluster = Potential::Options::Cluster;
  using Path = Potential::Options::Path;
  for (const Cluster cluster : {Cluster::kStreamline, Cluster::kFlux, Cluster::kFluxPerLength}) {
    for (const Path path : {Path::kStreamline, Path::kShortest, Path::kTraceBack}) {
      if (path == Path::kStreamline && cluster != Cluster::kStreamline) continue;
      for (const double source_radius : {0.0, 0.3}) {
        for (const double screening : {0.0, 0.6}) {
          Potential potential({.source_radius = source_radius,
                               .screening_length = screening,
                               .cluster = cluster,
                               .path = path});
          const Choice choice = potential.Choose(situation());
          ExpectGoodPath(choice);
          ExpectEndsAtTheCandidate(choice);
          if (path == Path::kShortest) {
            EXPECT_LE(PathLength(choice.path_W), 1.004 * candidates_[choice.candidate].length + 1e-9);
          }
        }
      }
    }
  }
}

TEST_P(StrategiesOnRandomMaps, PotentialTakesWhatIsAtHandAtOnce) {
  Potential potential({.source_radius = candidates_[Nearest()].length + 0.01});
  EXPECT_EQ(potential.Choose(situation()).candidate, Nearest());
}

TEST_P(StrategiesOnRandomMaps, RandomDrawsTheSameAgainFromTheSameSeed) {
  TakeFrontiers();
  const auto draws = [&](std::uint32_t seed) {
    Random strategy({.seed = seed});
    std::vector<std::size_t> drawn;
    for (int n = 0; n < 40; ++n) drawn.push_back(strategy.Choose(situation()).candidate);
    return drawn;
  };
  EXPECT_EQ(draws(3), draws(3));
  EXPECT_NE(draws(3), draws(4));
}

TEST_P(StrategiesOnRandomMaps, RandomDrawsEveryUnknownVoxelAsOften) {
  TakeFrontiers();
  std::size_t voxels = 0;
  for (const Candidate& candidate : candidates_) voxels += candidate.cluster.unknowns.size();
  const auto strategy = Make("random");
  std::map<std::size_t, int> drawn;
  constexpr int kDraws = 4000;
  for (int n = 0; n < kDraws; ++n) ++drawn[strategy->Choose(situation()).candidate];
  for (std::size_t n = 0; n < candidates_.size(); ++n) {
    const double share =
        static_cast<double>(candidates_[n].cluster.unknowns.size()) / static_cast<double>(voxels);
    const double spread = std::sqrt(kDraws * share * (1.0 - share));
    EXPECT_NEAR(drawn[n], kDraws * share, 5.0 * spread + 1.0);
  }
}

TEST_P(StrategiesOnRandomMaps, GainsGoWhereBruteForceFindsMost) {
  TakeFrontiers();
  std::vector<VoxelIndex> targets;
  for (const Candidate& candidate : candidates_) {
    targets.insert(targets.end(), candidate.cluster.unknowns.begin(), candidate.cluster.unknowns.end());
  }
  constexpr double kShare = 0.2;
  for (const double decay : {0.0, 0.2, 2.0}) {
    SensorGain gain(kViews, kSize, kSensorRange);
    gain.Follow(map_, targets);
    double best = 0.0;
    for (const VoxelIndex& i : test::TraversableVoxels(map_)) {
      if (!InformationGain::Sampled(i, kShare) || !search_.Reached(i)) continue;
      best = std::max(best, gain.BestView(i).value * std::exp(-decay * search_.Length(i)));
    }
    InformationGain strategy({.sample_share = kShare, .decay = decay}, decay);
    const Choice choice = strategy.Choose(situation());
    const VoxelIndex place = map_.IndexOf(choice.path_W.back());
    EXPECT_TRUE(InformationGain::Sampled(place, kShare));
    EXPECT_EQ(gain.BestView(place).value * std::exp(-decay * search_.Length(place)), best);
    EXPECT_EQ(choice.target, gain.BestView(place).seen);
    ExpectGoodPath(choice);
  }
}

TEST(InformationGains, SampleTheShareOfVoxelsThatWasAskedFor) {
  for (const double share : {0.05, 0.3}) {
    int sampled = 0;
    test::ForEachVoxel({{-20, -20, -20}, {20, 20, 20}},
                       [&](const VoxelIndex& i) { sampled += InformationGain::Sampled(i, share) ? 1 : 0; });
    EXPECT_NEAR(sampled / 64000.0, share, 0.005);
  }
}

/// A room of 7 x 3 x 1.2 m with the robot at one end and isolated unknown voxels in it.
class RoomWithSpecks : public testing::Test {
 protected:
  Choice FlowAmong(const std::vector<VoxelIndex>& specks, double sight_worth = 0.0) {
    PutSpecks(specks);
    return Flow({.eagerness = 0.0, .sight_worth = sight_worth}).Choose(situation());
  }
  Situation situation() const {
    return {map_, search_, map_.CenterOf(kStart), kClearance, candidates_, kViews, kSensorRange, kLookRange};
  }
  void PutSpecks(const std::vector<VoxelIndex>& specks) {
    map_.Apply(test::BoxOf({{0, 0, 0}, {70, 30, 12}}, VoxelState::kFree));
    for (const VoxelIndex& speck : specks)
      map_.Apply(test::BoxOf({speck, speck + VoxelIndex{1, 1, 1}}, VoxelState::kUnknown));
    search_.Flood(map_, {{kStart, 0}});
    for (const VoxelIndex& speck : specks) {
      Candidate candidate;
      candidate.cluster = {.unknowns = {speck}, .center_W = map_.CenterOf(speck)};
      const VoxelIndex* goal = nullptr;
      traversable_ = test::TraversableVoxels(map_);
      for (const VoxelIndex& i : traversable_) {
        if (!Sees(i, speck)) continue;
        const auto apart = [&](const VoxelIndex& j) {
          return (map_.CenterOf(j) - map_.CenterOf(speck)).norm();
        };
        if (goal == nullptr || apart(i) < apart(*goal)) goal = &i;
      }
      candidate.goals = {*goal};
      candidate.length = search_.Length(*goal);
      candidates_.push_back(std::move(candidate));
    }
  }
  bool Sees(const VoxelIndex& from, const VoxelIndex& speck) const {
    const Eigen::Vector3d p_W = map_.CenterOf(from);
    const Eigen::Vector3d q_W = map_.CenterOf(speck);
    return (p_W - q_W).norm() <= kLookRange && kViews.CanShow(q_W - p_W) && map_.InSight(p_W, q_W);
  }

  static constexpr VoxelIndex kStart{4, 15, 6};
  PlanningMap map_{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  std::vector<VoxelIndex> traversable_;
  std::vector<Candidate> candidates_;
};

TEST_F(RoomWithSpecks, FlowStopsWhereItSeesAll) {
  const std::vector<VoxelIndex> specks = {{60, 4, 6}, {62, 26, 6}};
  const Choice choice = FlowAmong(specks);
  const VoxelIndex end = map_.IndexOf(choice.path_W.back());
  EXPECT_TRUE(Sees(end, specks[0]));
  EXPECT_TRUE(Sees(end, specks[1]));
  EXPECT_THAT(choice.target, testing::UnorderedElementsAreArray(specks));
  double shortest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& i : traversable_) {
    if (Sees(i, specks[0]) && Sees(i, specks[1])) shortest = std::min(shortest, search_.Length(i));
  }
  EXPECT_LE(search_.Length(end), shortest + 0.4);  // one voxel of each cell of three was tried
}

TEST_F(RoomWithSpecks, FlowSeesTheFirstOnItsWayToTheSecond) {
  // Both ends of the room's length: too far apart to be seen from one position.
  const std::vector<VoxelIndex> specks = {{20, 4, 6}, {66, 26, 6}};
  const Choice choice = FlowAmong(specks);
  ASSERT_EQ(choice.candidate, 0U);
  const VoxelIndex end = map_.IndexOf(choice.path_W.back());
  EXPECT_TRUE(Sees(end, specks[0]));
  PathSearch onward;
  onward.Flood(map_, {{candidates_[1].goals.front(), 0}});
  // Rays leave gaps between the positions that were tried.
  EXPECT_LE(search_.Length(end) + onward.Length(end), onward.Length(kStart) + 0.2);
}

TEST_F(RoomWithSpecks, FlowGoesOnWhereItSeesPartOfALaterStop) {
  // The second and the third voxel form one stop, because they are near each other.
  const std::vector<VoxelIndex> specks = {{10, 4, 6}, {58, 26, 6}, {67, 26, 6}};
  const Choice thrifty = FlowAmong(specks);
  EXPECT_EQ(thrifty.candidate, 0U);
  EXPECT_THAT(thrifty.target, testing::ElementsAre(specks[0]));
  candidates_.clear();
  const Choice far_sighted = FlowAmong(specks, 100.0);
  EXPECT_EQ(far_sighted.candidate, 0U);
  EXPECT_THAT(far_sighted.target, testing::ElementsAre(specks[0], specks[1]));
  EXPECT_TRUE(Sees(map_.IndexOf(far_sighted.path_W.back()), specks[1]));
}

TEST_F(RoomWithSpecks, CoverMakesNoDetourWhereOnePositionSeesAll) {
  const std::vector<VoxelIndex> specks = {{60, 4, 6}, {62, 26, 6}};
  PutSpecks(specks);
  double shortest = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& i : traversable_) {
    if (Sees(i, specks[0]) && Sees(i, specks[1])) shortest = std::min(shortest, search_.Length(i));
  }
  const Choice choice = Cover({.least_yield = 0.0}).Choose(situation());
  const VoxelIndex end = map_.IndexOf(choice.path_W.back());
  ASSERT_FALSE(choice.target.empty());
  PathSearch onward;
  onward.Flood(map_, {{end, 0}});
  double longest_rest = 0.0;  // to what is not seen from there
  for (const VoxelIndex& speck : specks) {
    double rest = std::numeric_limits<double>::infinity();
    for (const VoxelIndex& i : traversable_) {
      if (Sees(i, speck)) rest = std::min(rest, onward.Length(i));
    }
    longest_rest = std::max(longest_rest, rest);
    EXPECT_EQ(testing::Value(choice.target, testing::Contains(speck)), Sees(end, speck));
  }
  // One voxel of each cell of 0.4 m was tried.
  EXPECT_LE(search_.Length(end) + longest_rest, shortest + 0.8);
}

TEST_F(RoomWithSpecks, CoverLeavesOutWhatIsNotWorthItsPath) {
  PutSpecks({{60, 4, 6}});  // 0.01 m^2, some 3 m away
  EXPECT_TRUE(Cover({.least_yield = 0.1}).Choose(situation()).path_W.empty());
  EXPECT_FALSE(Cover({.least_yield = 0.001}).Choose(situation()).path_W.empty());
}

TEST_F(RoomWithSpecks, CoverTurnsToWhatItSeesFromHereButOnlyOnce) {
  std::vector<VoxelIndex> near;
  for (int y = 9; y < 21; ++y) near.push_back({20, y, 6});
  PutSpecks(near);
  Cover cover({.least_yield = 0.0});
  const Choice look = cover.Choose(situation());
  EXPECT_THAT(look.path_W, testing::Each(map_.CenterOf(kStart)));
  EXPECT_THAT(look.target, testing::IsSubsetOf(near));
  EXPECT_GE(look.target.size(), 10U);
  // Whatever the look has not resolved is looked at from elsewhere.
  const Choice go = cover.Choose(situation());
  EXPECT_GT(PathLength(go.path_W), 0.2);
}

TEST(Covers, RefuseOptionsThatMakeNoSense) {
  EXPECT_THROW(Cover({.eagerness = -1.0}), std::invalid_argument);
  EXPECT_THROW(Cover({.hysteresis = -0.1}), std::invalid_argument);
  EXPECT_THROW(Cover({.least_yield = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(Cover({.iterations = -1}), std::invalid_argument);
}

/// A straight corridor with the robot in it and a candidate on each side.
class Corridor : public testing::Test {
 protected:
  Corridor() { map_.Apply(test::BoxOf({{-60, -3, -3}, {60, 4, 4}}, VoxelState::kFree)); }

  void PutCandidates(const std::vector<std::vector<VoxelIndex>>& goals) {
    search_.Flood(map_, {{{0, 0, 0}, 0}});
    candidates_.clear();
    for (const std::vector<VoxelIndex>& of_one : goals) {
      candidates_.push_back(CandidateAt(of_one, search_));
    }
  }
  Choice Decide(const char* name) const {
    return Make(name)->Choose(
        {map_, search_, map_.CenterOf({0, 0, 0}), kClearance, candidates_, kViews, kSensorRange, kLookRange});
  }
  Choice ChooseAmong(const std::vector<std::vector<VoxelIndex>>& goals) {
    PutCandidates(goals);
    return Decide("potential_flux");
  }

  PlanningMap map_{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  std::vector<Candidate> candidates_;
};

TEST_F(Corridor, OfTwoEqualCandidatesFluxTakesTheNearer) {
  EXPECT_EQ(ChooseAmong({{{-40, 0, 0}}, {{20, 0, 0}}}).candidate, 1U);
  EXPECT_EQ(ChooseAmong({{{-20, 0, 0}}, {{40, 0, 0}}}).candidate, 0U);
}

TEST_F(Corridor, OfTwoAtTheSameDistanceFluxTakesTheWider) {
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

TEST_F(Corridor, OfTwoAtTheSameDistancePotentialLeavesTheDoubtfulOne) {
  for (const char* name : {"potential", "potential_flux"}) {
    for (const std::size_t doubtful : {0U, 1U}) {
      PutCandidates({{{-30, 0, 0}}, {{30, 0, 0}}});
      candidates_[doubtful].cluster.doubtful = true;
      EXPECT_EQ(Decide(name).candidate, 1U - doubtful) << name;
    }
  }
}

TEST_F(Corridor, APlaceThatSeesBothAnUnknownAndADoubtfulClusterIsASinkOfTheUnknownOne) {
  for (const char* name : {"potential", "potential_flux"}) {
    for (const std::size_t doubtful : {0U, 1U}) {
      PutCandidates({{{30, 0, 0}}, {{30, 0, 0}}, {{-29, 0, 0}}});
      candidates_[doubtful].cluster.doubtful = true;
      candidates_[2].cluster.doubtful = true;
      EXPECT_EQ(Decide(name).candidate, 1U - doubtful) << name;
    }
  }
}

TEST_F(Corridor, FlowGoesToADoubtfulClusterAfterAnUnknownOne) {
  for (const bool doubtful : {false, true}) {
    PutCandidates({{{-40, 0, 0}}, {{42, 0, 0}}});  // the unknown spaces beyond both ends have the same size
    test::ForEachVoxel({{-61, -2, -2}, {-60, 3, 3}}, [&](const VoxelIndex& i) {
      candidates_[0].cluster.unknowns.push_back(i);
      candidates_[1].cluster.unknowns.push_back({-1 - i.x, i.y, i.z});
    });
    candidates_[0].cluster.doubtful = doubtful;
    candidates_[0].cluster.weight = doubtful ? 0.5 : 1.0;
    EXPECT_EQ(Decide("flow").candidate, doubtful ? 1U : 0U);
  }
}

}  // namespace
}  // namespace thalweg::explorer
