#include "services/explorer/core/map/look_memory.h"

#include <gtest/gtest.h>

#include "common/voxel/for_each_voxel.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;

constexpr VoxelIndex kVoxel{2, 3, 4};
constexpr VoxelBox kBox{{0, 0, 0}, {8, 8, 8}};
const Time kNow{100s};

PlanningMap::StateChange Becomes(const VoxelIndex& i, VoxelState before, VoxelState now,
                                 bool doubtful_before = false, bool doubtful_now = false) {
  return {i, before, now, doubtful_before, doubtful_now};
}

class LookMemoryTest : public testing::Test {
 protected:
  LookMemoryTest() { memory_.Cover(kBox); }
  bool Aside() const { return memory_.set_aside()[kVoxel] != 0; }
  void SetAsideByLooks(Time now) {
    for (int n = 0; n < 2; ++n) memory_.CountLook(kVoxel, AsideReason::kLookedAt, Sensed::kDepth, now);
  }
  void FreeNeighbor() {
    const auto change = Becomes(kVoxel + VoxelIndex{0, 1, 0}, VoxelState::kUnknown, VoxelState::kFree);
    memory_.Follow({&change, 1});
  }

  LookMemory memory_{{.looks = 2, .apart = 0.25, .expiry = 300s, .chances = 3}};
};

TEST_F(LookMemoryTest, ASecondLookFromNearbyDoesNotCount) {
  memory_.Look(kVoxel, {1.0, 1.0, 1.0}, Sensed::kDepth, kNow);
  memory_.Look(kVoxel, {1.24, 1.0, 1.0}, Sensed::kDepth, kNow);
  memory_.Look(kVoxel, {1.0, 0.8, 1.1}, Sensed::kDepth, kNow);
  EXPECT_EQ(memory_.Looks(kVoxel), 1);
  EXPECT_FALSE(Aside());
}

TEST_F(LookMemoryTest, ASecondLookFromAQuarterOfAMeterAwayCountsAndSetsAside) {
  memory_.Look(kVoxel, {1.0, 1.0, 1.0}, Sensed::kDepth, kNow);
  memory_.Look(kVoxel, {1.25, 1.0, 1.0}, Sensed::kDepth, kNow);
  EXPECT_EQ(memory_.Looks(kVoxel), 2);
  EXPECT_TRUE(Aside());
  const auto voxels = memory_.SetAsideVoxels();
  ASSERT_EQ(voxels.size(), 1U);
  EXPECT_EQ(voxels.at(AsideReason::kLookedAt), std::vector<VoxelIndex>{kVoxel});
}

TEST_F(LookMemoryTest, APlannedLookCountsWhateverThePlace) {
  memory_.Look(kVoxel, {1.0, 1.0, 1.0}, Sensed::kDepth, kNow);
  memory_.CountLook(kVoxel, AsideReason::kLookedAt, Sensed::kDepth, kNow);
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, WhatWasMostlyLookedAtWithoutADepthSaysSo) {
  constexpr Sensed kDepth = Sensed::kDepth;
  constexpr Sensed kNothing = Sensed::kNothing;
  const struct {
    std::vector<Sensed> looks;
    AsideReason reason;
  } cases[] = {
      {{kDepth, kDepth, kDepth}, AsideReason::kLookedAt},
      {{kDepth, kNothing, kDepth}, AsideReason::kLookedAt},
      {{kDepth, kNothing, kNothing}, AsideReason::kNoDepth},
      {{kNothing, kNothing, kNothing}, AsideReason::kNoDepth},
      {{kDepth, kNothing}, AsideReason::kLookedAt},
      {{kNothing, kNothing}, AsideReason::kNoDepth},
      {{kNothing}, AsideReason::kNoDepth},
  };
  for (const auto& [looks, reason] : cases) {
    LookMemory memory({.looks = static_cast<int>(looks.size())});
    memory.Cover(kBox);
    for (std::size_t n = 0; n < looks.size(); ++n) {
      EXPECT_TRUE(memory.SetAsideVoxels().empty());
      memory.Look(kVoxel, {static_cast<double>(n), 0.0, 0.0}, looks[n], kNow);
    }
    const auto voxels = memory.SetAsideVoxels();
    ASSERT_EQ(voxels.size(), 1U);
    EXPECT_EQ(voxels.begin()->first, reason);
  }
}

TEST_F(LookMemoryTest, ALookThatDoesNotCountDoesNotCountAsOneWithoutADepthEither) {
  memory_.Look(kVoxel, {1.0, 1.0, 1.0}, Sensed::kNothing, kNow);
  for (int n = 0; n < 5; ++n) memory_.Look(kVoxel, {1.1, 1.0, 1.0}, Sensed::kNothing, kNow);
  EXPECT_FALSE(Aside());
  memory_.Look(kVoxel, {2.0, 1.0, 1.0}, Sensed::kDepth, kNow);
  EXPECT_TRUE(memory_.SetAsideVoxels().contains(AsideReason::kLookedAt));
}

TEST_F(LookMemoryTest, AnotherChanceIsDecidedByTheNextLookAgain) {
  const auto reason_after = [&](Sensed first, Sensed after) {
    memory_.Clear();
    for (int n = 0; n < 2; ++n) memory_.CountLook(kVoxel, AsideReason::kLookedAt, first, kNow);
    // Looks at voxels that are set aside continue, and may sense something else.
    for (int n = 0; n < 20; ++n) memory_.CountLook(kVoxel, AsideReason::kLookedAt, after, kNow);
    memory_.Expire(kNow + 301s);
    EXPECT_FALSE(Aside());
    EXPECT_EQ(memory_.Looks(kVoxel), 1);
    memory_.CountLook(kVoxel, AsideReason::kLookedAt, after, kNow + 301s);
    return memory_.SetAsideVoxels().begin()->first;
  };
  EXPECT_EQ(reason_after(Sensed::kNothing, Sensed::kNothing), AsideReason::kNoDepth);
  EXPECT_EQ(reason_after(Sensed::kNothing, Sensed::kDepth), AsideReason::kLookedAt);
  EXPECT_EQ(reason_after(Sensed::kDepth, Sensed::kNothing), AsideReason::kLookedAt);
  EXPECT_EQ(reason_after(Sensed::kDepth, Sensed::kDepth), AsideReason::kLookedAt);
}

TEST_F(LookMemoryTest, AClockThatGoesBackMakesNothingYounger) {
  memory_.SetAside(kVoxel, AsideReason::kVisited, kNow);
  memory_.ShiftTimes(90s);
  memory_.Expire(kNow - 90s + 300s);
  EXPECT_TRUE(Aside());
  memory_.Expire(kNow - 90s + 301s);
  EXPECT_FALSE(Aside());
}

TEST_F(LookMemoryTest, TheFirstReasonStays) {
  memory_.SetAside(kVoxel, AsideReason::kVisited, kNow);
  memory_.SetAside(kVoxel, AsideReason::kOutOfSight, kNow);
  EXPECT_TRUE(memory_.SetAsideVoxels().contains(AsideReason::kVisited));
  EXPECT_EQ(memory_.Release(AsideReason::kOutOfSight), 0U);
  EXPECT_EQ(memory_.Release(AsideReason::kVisited), 1U);
  EXPECT_FALSE(Aside());
}

TEST_F(LookMemoryTest, SomeVoxelsSetAsideForAReasonAreReleasedAlone) {
  const VoxelIndex other{5, 5, 5};
  const std::vector<VoxelIndex> voxels = {kVoxel, {20, 20, 20}};  // one outside what it covers
  for (const VoxelIndex& i : {kVoxel, other}) memory_.SetAside(i, AsideReason::kOutOfSight, kNow);
  memory_.Release(AsideReason::kVisited, voxels);
  EXPECT_TRUE(Aside());
  memory_.Release(AsideReason::kOutOfSight, voxels);
  EXPECT_FALSE(Aside());
  EXPECT_EQ(memory_.Count(AsideReason::kOutOfSight), 1U);
}

TEST_F(LookMemoryTest, ANewFreeNeighborReopensAtMostThreeTimes) {
  for (int chance = 0; chance < 3; ++chance) {
    SetAsideByLooks(kNow);
    ASSERT_TRUE(Aside());
    FreeNeighbor();
    EXPECT_FALSE(Aside()) << chance;
    EXPECT_EQ(memory_.Looks(kVoxel), 1) << "one look more decides";
  }
  SetAsideByLooks(kNow);
  FreeNeighbor();
  EXPECT_TRUE(Aside());
  memory_.Expire(kNow + 1000s);
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, WhatWasSeenInVainIsReopenedOnDemandAsOftenAsItHasChances) {
  for (int chance = 0; chance < 3; ++chance) {
    SetAsideByLooks(kNow);
    EXPECT_EQ(memory_.ReopenInVain(CubeAround(kVoxel, 1)), 1U);
    EXPECT_FALSE(Aside()) << chance;
    EXPECT_EQ(memory_.ReopenInVain(CubeAround(kVoxel, 1)), 0U) << "it is a target already";
  }
  SetAsideByLooks(kNow);
  EXPECT_EQ(memory_.ReopenInVain(CubeAround(kVoxel, 1)), 0U);
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, WhatWasSeenInVainElsewhereIsNotReopened) {
  SetAsideByLooks(kNow);
  EXPECT_EQ(memory_.ReopenInVain({kVoxel + VoxelIndex{1, 0, 0}, kVoxel + VoxelIndex{3, 1, 1}}), 0U);
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, WhatWasSetAsideEarlierCanBeReleasedAlone) {
  memory_.SetAside(kVoxel, AsideReason::kNoRoom, kNow);
  EXPECT_EQ(memory_.Release(AsideReason::kNoRoom, kNow), 0U);
  EXPECT_EQ(memory_.Release(AsideReason::kVisited, kNow + 1s), 0U);
  EXPECT_TRUE(Aside());
  EXPECT_EQ(memory_.Release(AsideReason::kNoRoom, kNow + 1s), 1U);
  EXPECT_FALSE(Aside());
}

TEST_F(LookMemoryTest, WhatNobodyTriedToSeeIsNotReopenedAsInVain) {
  for (const AsideReason reason :
       {AsideReason::kOutOfSight, AsideReason::kLostThere, AsideReason::kIgnored}) {
    memory_.Clear();
    memory_.SetAside(kVoxel, reason, kNow);
    EXPECT_EQ(memory_.ReopenInVain(CubeAround(kVoxel, 1)), 0U) << NameOf(reason);
    EXPECT_TRUE(Aside());
  }
}

TEST_F(LookMemoryTest, ANewOccupiedNeighborOrAFreeOneAtACornerReopensNothing) {
  SetAsideByLooks(kNow);
  const PlanningMap::StateChange changes[] = {
      Becomes(kVoxel + VoxelIndex{0, 1, 0}, VoxelState::kUnknown, VoxelState::kOccupied),
      Becomes(kVoxel + VoxelIndex{1, 1, 0}, VoxelState::kUnknown, VoxelState::kFree)};
  memory_.Follow(changes);
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, ExpiresOnlyAfterTheExpiry) {
  SetAsideByLooks(kNow);
  memory_.Expire(kNow + 300s);
  EXPECT_TRUE(Aside());
  memory_.Expire(kNow + 301s);
  EXPECT_FALSE(Aside());
  SetAsideByLooks(kNow + 400s);
  memory_.Expire(kNow + 600s);
  EXPECT_TRUE(Aside()) << "it was set aside again";
}

TEST_F(LookMemoryTest, WhatBecameKnownIsForgotten) {
  for (int n = 0; n < 5; ++n) {
    SetAsideByLooks(kNow);
    const auto known = Becomes(kVoxel, VoxelState::kUnknown, VoxelState::kOccupied);
    memory_.Follow({&known, 1});
    EXPECT_FALSE(Aside());
    EXPECT_EQ(memory_.Looks(kVoxel), 0);
  }
  // It has its chances back, too.
  SetAsideByLooks(kNow);
  FreeNeighbor();
  EXPECT_FALSE(Aside());
}

TEST_F(LookMemoryTest, ADoubtfulVoxelThatBecameSureIsNoLongerSetAside) {
  const auto doubtful = Becomes(kVoxel, VoxelState::kUnknown, VoxelState::kFree, false, true);
  memory_.Follow({&doubtful, 1});
  SetAsideByLooks(kNow);
  ASSERT_TRUE(Aside());
  const auto other_side = Becomes(kVoxel, VoxelState::kFree, VoxelState::kOccupied, true, true);
  memory_.Follow({&other_side, 1});
  EXPECT_TRUE(Aside()) << "it is as doubtful as before";
  const auto sure = Becomes(kVoxel, VoxelState::kOccupied, VoxelState::kOccupied, true, false);
  memory_.Follow({&sure, 1});
  EXPECT_FALSE(Aside());
}

TEST_F(LookMemoryTest, AVoxelThatIsDoubtfulAgainAndAgainIsAskedForThreeTimesAtMost) {
  const auto known = Becomes(kVoxel, VoxelState::kUnknown, VoxelState::kOccupied);
  memory_.Follow({&known, 1});
  const auto doubtful = Becomes(kVoxel, VoxelState::kOccupied, VoxelState::kOccupied, false, true);
  const auto sure = Becomes(kVoxel, VoxelState::kOccupied, VoxelState::kOccupied, true, false);
  for (int chance = 0; chance < 3; ++chance) {
    memory_.Follow({&doubtful, 1});
    EXPECT_FALSE(Aside()) << chance;
    memory_.Follow({&sure, 1});
  }
  memory_.Follow({&doubtful, 1});
  EXPECT_TRUE(Aside());
  memory_.Expire(kNow + 10'000s);
  FreeNeighbor();
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, AFreeVoxelThatOnlyBecomesDoubtfulReopensNothingBesideIt) {
  SetAsideByLooks(kNow);
  const auto beside =
      Becomes(kVoxel + VoxelIndex{0, 1, 0}, VoxelState::kFree, VoxelState::kFree, false, true);
  memory_.Follow({&beside, 1});
  EXPECT_TRUE(Aside());
}

TEST_F(LookMemoryTest, AGrowingBoxForgetsNothing) {
  memory_.Look(kVoxel, {1.0, 1.0, 1.0}, Sensed::kDepth, kNow);
  memory_.SetAside({7, 0, 7}, AsideReason::kVisited, kNow);
  memory_.Cover({{-20, -3, 0}, {9, 8, 30}});
  EXPECT_EQ(memory_.Looks(kVoxel), 1);
  EXPECT_EQ(memory_.Looks({-20, -3, 0}), 0);
  EXPECT_EQ(memory_.SetAsideVoxels().at(AsideReason::kVisited), (std::vector<VoxelIndex>{{7, 0, 7}}));
  memory_.Look(kVoxel, {1.1, 1.0, 1.0}, Sensed::kDepth, kNow);
  EXPECT_EQ(memory_.Looks(kVoxel), 1) << "where it was looked at from is kept, too";
  memory_.Expire(kNow + 200s);
  EXPECT_FALSE(memory_.SetAsideVoxels().empty()) << "and since when";
}

TEST_F(LookMemoryTest, ClearForgetsAll) {
  SetAsideByLooks(kNow);
  memory_.Clear();
  EXPECT_FALSE(Aside());
  EXPECT_EQ(memory_.Looks(kVoxel), 0);
}

TEST_F(LookMemoryTest, ChangesAtTheRimOfTheBoxAreFollowed) {
  const auto corner = Becomes({7, 7, 7}, VoxelState::kUnknown, VoxelState::kFree);
  memory_.SetAside({7, 7, 6}, AsideReason::kVisited, kNow);
  memory_.Follow({&corner, 1});
  EXPECT_TRUE(memory_.SetAsideVoxels().empty());
}

}  // namespace
}  // namespace thalweg::explorer
