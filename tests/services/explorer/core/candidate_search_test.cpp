#include "services/explorer/core/candidate_search.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using test::kNow;

Mission AnyMission() {
  return Mission({.time_budget = {}, .distance_budget = 0.0, .return_home = false, .home_paths = {}});
}

std::vector<VoxelIndex> AsideIn(const Knowledge& knowledge, AsideReason reason) {
  const auto voxels = knowledge.memory().SetAsideVoxels();
  const auto found = voxels.find(reason);
  return found == voxels.end() ? std::vector<VoxelIndex>{} : found->second;
}

/// Random maps, each with a closed box beside it that holds a target which no place can see.
class CandidatesOnRandomMaps : public testing::TestWithParam<unsigned> {
 protected:
  static constexpr VoxelIndex kHidden{42, 2, 2};

  CandidatesOnRandomMaps() {
    std::vector<VoxelChange> changes = test::RandomScene(random_, {{0, 0, 0}, {34, 30, 22}}, 22, 8);
    for (const VoxelChange& change : test::ClosedRoom({{41, 1, 1}, {44, 4, 4}})) changes.push_back(change);
    std::erase_if(changes, [](const VoxelChange& change) { return change.voxel == kHidden; });
    knowledge_.Update(changes, {}, kNow);
    const std::vector<VoxelIndex> places = test::TraversableVoxels(map());
    PathSearch search;
    do {
      start_ = places[random_() % places.size()];
      search.Flood(map(), {{start_, 0}});
    } while (2 * search.reached_count() < places.size());
  }
  const PlanningMap& map() const { return knowledge_.map(); }

  std::mt19937 random_{GetParam()};
  Knowledge knowledge_{test::KnowingOptions()};
  VoxelIndex start_;
  CandidateSearch search_{test::SearchingOptions()};
  StageTimings timings_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, CandidatesOnRandomMaps, testing::Range(1U, 11U));

TEST_P(CandidatesOnRandomMaps, EachTargetBelongsToACandidateOrIsOutOfSight) {
  std::set<std::tuple<int, int, int>> left;
  test::ForEachVoxel(map().box(), [&](const VoxelIndex& i) {
    if (IsTarget(map(), i)) left.insert({i.x, i.y, i.z});
  });
  ASSERT_FALSE(left.empty());
  search_.Find(map().CenterOf(start_), AnyMission(), kNow, knowledge_, timings_);
  PathSearch flood;
  flood.Flood(map(), {{start_, 0}});
  ASSERT_FALSE(search_.candidates().empty());
  for (const Candidate& candidate : search_.candidates()) {
    for (const VoxelIndex& i : candidate.cluster.unknowns) EXPECT_EQ(left.erase({i.x, i.y, i.z}), 1U);
    ASSERT_FALSE(candidate.goals.empty());
    for (const VoxelIndex& goal : candidate.goals) {
      ASSERT_TRUE(flood.Reached(goal));
      EXPECT_TRUE(std::ranges::any_of(candidate.cluster.unknowns, [&](const VoxelIndex& i) {
        return knowledge_.views().CanSee(map(), map().CenterOf(goal), map().CenterOf(i), 2.0 + 1e-9);
      }));
    }
    EXPECT_EQ(candidate.length, flood.Length(candidate.goals.front()));
    EXPECT_EQ(candidate.turn, 0.0);
  }
  EXPECT_TRUE(left.contains({kHidden.x, kHidden.y, kHidden.z}));
  for (const VoxelIndex& i : AsideIn(knowledge_, AsideReason::kOutOfSight))
    EXPECT_EQ(left.erase({i.x, i.y, i.z}), 1U);
  EXPECT_TRUE(left.empty());
  for (const char* const stage : {"flood", "frontiers", "goals"})
    EXPECT_EQ(timings_[stage].count(), 1U) << stage;
}

TEST_P(CandidatesOnRandomMaps, ThoseThatABudgetDoesNotAllowAreDropped) {
  Mission mission({.time_budget = {}, .distance_budget = 4.0, .return_home = true, .home_paths = {}});
  const Eigen::Vector3d home_W = map().CenterOf(start_);
  mission.FindPathsHome(map(), home_W);
  mission.Move(home_W);
  search_.Find(home_W, mission, kNow, knowledge_, timings_);
  std::vector<double> kept;
  for (const Candidate& candidate : search_.candidates()) {
    const double length = candidate.length;
    if (!mission.TooFar(map(), length, map().CenterOf(candidate.goals.front()), kNow)) kept.push_back(length);
  }
  ASSERT_LT(kept.size(), search_.candidates().size()) << "nothing is too far";
  EXPECT_EQ(search_.DropTooFar(map(), mission, kNow), Budget::kDistance);
  std::vector<double> lengths;
  for (const Candidate& candidate : search_.candidates()) lengths.push_back(candidate.length);
  EXPECT_EQ(lengths, kept);
  EXPECT_EQ(search_.DropTooFar(map(), mission, kNow), std::nullopt);
}

TEST(CandidateSearch, WhatNoPlaceSawIsTriedAgainBeforeTheSearchEndsEmpty) {
  Knowledge knowledge = test::Knowing(test::LongRoom());
  test::ForEachVoxel({{60, 0, 0}, {61, 12, 12}}, [&](const VoxelIndex& i) {
    knowledge.memory().SetAside(i, AsideReason::kOutOfSight, kNow);
  });
  CandidateSearch search(test::SearchingOptions());
  StageTimings timings;
  const Eigen::Vector3d p_W(0.55, 0.65, 0.65);
  search.Find(p_W, AnyMission(), kNow, knowledge, timings);
  EXPECT_FALSE(search.candidates().empty()) << "it is in sight now";
  EXPECT_TRUE(AsideIn(knowledge, AsideReason::kOutOfSight).empty());

  knowledge = test::Knowing(test::LongRoom());
  test::ForEachVoxel({{60, 0, 0}, {61, 12, 12}}, [&](const VoxelIndex& i) {
    knowledge.memory().SetAside(i, AsideReason::kVisited, kNow);
  });
  search.Find(p_W, AnyMission(), kNow, knowledge, timings);
  EXPECT_TRUE(search.candidates().empty()) << "other reasons stay";
}

/// A room with a bar, and with an end out of sight behind it.
class BarredRoom : public testing::Test {
 protected:
  static constexpr std::size_t kFace = 12 * 12;  ///< [voxels]

  /// @param wall  Occupied voxels within the unknown space.
  void Divide(const VoxelBox& wall, AsideReason near_side) {
    std::vector<VoxelChange> changes = test::RoomWithABar(20);
    test::Fill(changes, wall, VoxelState::kOccupied);
    knowledge_ = test::Knowing(changes);
    SetAside(20, near_side);
    StageTimings timings;
    search_.Find({0.55, 0.65, 0.65}, AnyMission(), kNow, knowledge_, timings);
    ASSERT_TRUE(search_.candidates().empty());
    ASSERT_EQ(AsideIn(knowledge_, AsideReason::kOutOfSight).size(), 2 * kFace) << "far side and far end";
  }
  void SetAside(int x, AsideReason reason) {
    test::ForEachVoxel({{x, 0, 0}, {x + 1, 12, 12}},
                       [&](const VoxelIndex& i) { knowledge_.memory().SetAside(i, reason, kNow); });
  }

  static constexpr VoxelBox kNoWall{{0, 0, 0}, {0, 0, 0}};
  Knowledge knowledge_{test::KnowingOptions()};
  CandidateSearch search_{test::SearchingOptions()};
};

TEST_F(BarredRoom, WhatIsOutOfSightBehindSpaceLookedIntoInVainIsHidden) {
  Divide(kNoWall, AsideReason::kNoDepth);
  EXPECT_EQ(search_.FindHidden(knowledge_).voxels, 2 * kFace);
}

TEST_F(BarredRoom, WhatIsOutOfSightBehindWhatIsTooSmallToLookAtIsHidden) {
  Divide(kNoWall, AsideReason::kIgnored);
  knowledge_.memory().Clear();
  SetAside(23, AsideReason::kOutOfSight);
  SetAside(60, AsideReason::kOutOfSight);
  EXPECT_EQ(search_.FindHidden(knowledge_).voxels, 2 * kFace);
  StageTimings timings;
  CandidateSearch::Options options = test::SearchingOptions();
  options.frontier.min_area = 2.0;  // [m^2] more than the face, 1.44
  CandidateSearch search(options);
  search.Find({0.55, 0.65, 0.65}, AnyMission(), kNow, knowledge_, timings);
  ASSERT_TRUE(search.candidates().empty());
  search.FindSmallest({0.55, 0.65, 0.65}, AnyMission(), kNow, knowledge_, timings);
  EXPECT_FALSE(search.candidates().empty());
  search.Find({0.55, 0.65, 0.65}, AnyMission(), kNow, knowledge_, timings);
  EXPECT_TRUE(search.candidates().empty()) << "it asks for large ones again";
}

TEST_F(BarredRoom, NothingIsHiddenByWhatWasNotTried) {
  Divide(kNoWall, AsideReason::kIgnored);
  EXPECT_EQ(search_.FindHidden(knowledge_).voxels, 0U);
}

TEST_F(BarredRoom, WhatIsBehindAWallIsNotHiddenByUnknownSpace) {
  Divide({{21, 0, 0}, {22, 12, 12}}, AsideReason::kLookedAt);
  EXPECT_EQ(search_.FindHidden(knowledge_).voxels, 0U);
}

TEST_F(BarredRoom, TheRobotMustFitThroughWhatItLookedIntoInVain) {
  Divide({{21, 0, 0}, {22, 12, 6}}, AsideReason::kVisited);  // above it, 0.6 m are left of 1.2 m
  EXPECT_EQ(search_.FindHidden(knowledge_).voxels, 2 * kFace);
  Divide({{21, 0, 0}, {22, 12, 10}}, AsideReason::kVisited);  // 0.2 m, for a body of 0.3 m
  EXPECT_LE(search_.FindHidden(knowledge_).voxels, kFace) << "nothing but the far side, through the gap";
}

TEST(CandidateSearch, TakesWhatAStrategyFoundAndPricesIt) {
  CandidateSearch search(test::SearchingOptions());
  Knowledge knowledge = test::Knowing(test::LongRoom());
  StageTimings timings;
  search.Find({0.55, 0.65, 0.65}, AnyMission(), kNow, knowledge, timings);
  std::vector<Candidate> own(3);
  for (std::size_t n = 0; n < own.size(); ++n) own[n].length = static_cast<double>(n);
  search.Take(own);
  EXPECT_TRUE(search.frontiers().clusters.empty());
  search.PriceTurns([](const Candidate& candidate) { return 2.0 * candidate.length; });
  ASSERT_EQ(search.candidates().size(), 3U);
  for (const Candidate& candidate : search.candidates()) EXPECT_EQ(candidate.turn, 2.0 * candidate.length);
}

TEST(CandidateSearch, RefusesOptionsThatMakeNoSense) {
  CandidateSearch::Options options = test::SearchingOptions();
  options.frontier.min_area = -0.1;
  EXPECT_THROW(CandidateSearch{options}, std::invalid_argument);
  options = test::SearchingOptions();
  options.frontier.extent = 0.0;
  EXPECT_THROW(CandidateSearch{options}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
