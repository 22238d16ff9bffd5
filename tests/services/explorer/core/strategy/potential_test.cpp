#include "services/explorer/core/strategy/potential.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

TEST(Potential, APathThatDoesNotLeadToTheClusterIsRefused) {
  Potential::Options options;
  options.cluster = Potential::Options::Cluster::kFlux;
  EXPECT_THROW(Potential{options}, std::invalid_argument);
  options.path = Potential::Options::Path::kShortest;
  EXPECT_NO_THROW(Potential{options});
}

class PotentialOnRandomMaps : public test::OnRandomMaps {};
INSTANTIATE_TEST_SUITE_P(Seeds, PotentialOnRandomMaps, testing::Range(1U, 21U));

TEST_P(PotentialOnRandomMaps, EveryKindKeepsToFreeSpaceAndItsClearance) {
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

TEST_P(PotentialOnRandomMaps, TakesWhatIsAtHandAtOnce) {
  Potential potential({.source_radius = candidates_[Nearest()].length + 0.01});
  EXPECT_EQ(potential.Choose(situation()).candidate, Nearest());
}

class PotentialInACorridor : public test::Corridor {
 protected:
  Choice ChooseAmong(const std::vector<std::vector<VoxelIndex>>& goals) {
    PutCandidates(goals);
    return Decide("potential_flux");
  }
};

TEST_F(PotentialInACorridor, OfTwoEqualCandidatesFluxTakesTheNearer) {
  EXPECT_EQ(ChooseAmong({{{-40, 0, 0}}, {{20, 0, 0}}}).candidate, 1U);
  EXPECT_EQ(ChooseAmong({{{-20, 0, 0}}, {{40, 0, 0}}}).candidate, 0U);
}

TEST_F(PotentialInACorridor, OfTwoAtTheSameDistanceFluxTakesTheWider) {
  std::vector<VoxelIndex> across;
  test::ForEachVoxel({{30, -1, -1}, {31, 2, 2}}, [&](const VoxelIndex& i) {
    if (map_.Traversable(i)) across.push_back(i);
  });
  std::iter_swap(across.begin(), std::find(across.begin(), across.end(), VoxelIndex{30, 0, 0}));
  ASSERT_GT(across.size(), 4U);
  EXPECT_EQ(ChooseAmong({{{-30, 0, 0}}, across}).candidate, 1U);
}

TEST_F(PotentialInACorridor, WhatAnotherCandidateHidesFromTheFlowIsNotChosen) {
  std::vector<VoxelIndex> across;
  test::ForEachVoxel({{15, -3, -3}, {16, 4, 4}}, [&](const VoxelIndex& i) {
    if (map_.Traversable(i)) across.push_back(i);
  });
  std::iter_swap(across.begin(), std::find(across.begin(), across.end(), VoxelIndex{15, 0, 0}));
  EXPECT_EQ(ChooseAmong({{{16, 0, 0}, {17, 0, 0}, {18, 0, 0}}, across}).candidate, 1U);
}

TEST_F(PotentialInACorridor, OfTwoAtTheSameDistanceItLeavesTheDoubtfulOne) {
  for (const char* name : {"potential", "potential_flux"}) {
    for (const std::size_t doubtful : {0U, 1U}) {
      PutCandidates({{{-30, 0, 0}}, {{30, 0, 0}}});
      candidates_[doubtful].cluster.doubtful = true;
      EXPECT_EQ(Decide(name).candidate, 1U - doubtful) << name;
    }
  }
}

TEST_F(PotentialInACorridor, APlaceThatSeesBothAnUnknownAndADoubtfulClusterIsASinkOfTheUnknownOne) {
  for (const char* name : {"potential", "potential_flux"}) {
    for (const std::size_t doubtful : {0U, 1U}) {
      PutCandidates({{{30, 0, 0}}, {{30, 0, 0}}, {{-29, 0, 0}}});
      candidates_[doubtful].cluster.doubtful = true;
      candidates_[2].cluster.doubtful = true;
      EXPECT_EQ(Decide(name).candidate, 1U - doubtful) << name;
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
