#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/strategy/registry.h"
#include "services/explorer/core/strategy/strategy.h"
#include "tests/services/explorer/support/random_planning_map.h"

/// Situations in which strategies choose.
namespace thalweg::explorer::test {

using Obstacles = PlanningMap::Obstacles;

inline constexpr double kSensorRange = 3.0;
inline const ViewPlanner kViews(DepthSensorModel{}.camera, RobotModel{});

inline Candidate CandidateAt(std::vector<VoxelIndex> goals, const PathSearch& search) {
  Candidate candidate;
  candidate.cluster.center_W = Eigen::Vector3d::Zero();
  candidate.length = search.Length(goals.front());
  candidate.goals = std::move(goals);
  return candidate;
}

/// A random map, a robot at a random position in it, and candidates at random positions that it can reach.
class OnRandomMaps : public testing::TestWithParam<unsigned> {
 protected:
  OnRandomMaps() {
    map_.Apply(RandomScene(random_, {{0, 0, 0}, {34, 30, 22}}, 22, 8));
    const std::vector<VoxelIndex> traversable = TraversableVoxels(map_);
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
    EXPECT_GE(SampledClearance(map_, choice.path_W, Obstacles::kOccupiedAndUnknown, 0.3),
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

/// A room of 7 x 3 x 1.2 m with the robot at one end and isolated unknown voxels in it.
class RoomWithSpecks : public testing::Test {
 protected:
  Situation situation() const {
    return {map_, search_, map_.CenterOf(kStart), kClearance, candidates_, kViews, kSensorRange, kLookRange};
  }
  void PutSpecks(const std::vector<VoxelIndex>& specks) {
    map_.Apply(BoxOf({{0, 0, 0}, {70, 30, 12}}, VoxelState::kFree));
    for (const VoxelIndex& speck : specks)
      map_.Apply(BoxOf({speck, speck + VoxelIndex{1, 1, 1}}, VoxelState::kUnknown));
    search_.Flood(map_, {{kStart, 0}});
    for (const VoxelIndex& speck : specks) {
      Candidate candidate;
      candidate.cluster = {.unknowns = {speck}, .center_W = map_.CenterOf(speck)};
      const VoxelIndex* goal = nullptr;
      traversable_ = TraversableVoxels(map_);
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

/// A straight corridor with the robot in it, and candidates at chosen places.
class Corridor : public testing::Test {
 protected:
  Corridor() { map_.Apply(BoxOf({{-60, -3, -3}, {60, 4, 4}}, VoxelState::kFree)); }

  void PutCandidates(const std::vector<std::vector<VoxelIndex>>& goals) {
    search_.Flood(map_, {{{0, 0, 0}, 0}});
    candidates_.clear();
    for (const std::vector<VoxelIndex>& of_one : goals) {
      candidates_.push_back(CandidateAt(of_one, search_));
    }
  }
  Choice Decide(const char* name) const {
    return Configure(name).make()->Choose(
        {map_, search_, map_.CenterOf({0, 0, 0}), kClearance, candidates_, kViews, kSensorRange, kLookRange});
  }

  PlanningMap map_{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PathSearch search_;
  std::vector<Candidate> candidates_;
};

}  // namespace thalweg::explorer::test
