#include "services/explorer/core/map/planning_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;
using test::RandomInt;

constexpr double kSize = 0.1;
const Eigen::AlignedBox3d kBounds(Eigen::Vector3d(-0.3, 0.0, 0.2), Eigen::Vector3d(0.7, 1.1, 1.0));

/// The most recent state given to each voxel.
using Reference = std::unordered_map<VoxelIndex, VoxelState, VoxelIndexHash>;

VoxelState StateIn(const Reference& reference, const VoxelIndex& i) {
  const auto found = reference.find(i);
  return found == reference.end() ? VoxelState::kUnknown : found->second;
}

bool BruteTraversable(const Reference& reference, const PlanningMap& map, const VoxelIndex& i) {
  const PlanningMap::Options& options = map.options();
  const Eigen::Vector3d center = VoxelCenter(i, options.voxel_size);
  if (options.bounds && options.bounds->exteriorDistance(center) > 1e-9) return false;
  if (map.plane() && i.z != map.IndexOf({0.0, 0.0, *map.plane()}).z) return false;
  const double farthest = std::max(options.clearance, options.half_height);
  const int reach = static_cast<int>(std::ceil(farthest / options.voxel_size)) + 1;
  const VoxelIndex by{reach, reach, reach};
  const auto no_go = [&](const VoxelIndex& j) {
    const Eigen::AlignedBox3d voxel(VoxelCenter(j, options.voxel_size).array() - 0.499 * options.voxel_size,
                                    VoxelCenter(j, options.voxel_size).array() + 0.499 * options.voxel_size);
    return std::any_of(options.no_go.begin(), options.no_go.end(),
                       [&](const Eigen::AlignedBox3d& box) { return box.intersects(voxel); });
  };
  bool fits = true;
  test::ForEachVoxel({i - by, i + by + VoxelIndex{1, 1, 1}}, [&](const VoxelIndex& j) {
    if (StateIn(reference, j) == VoxelState::kFree && !no_go(j)) return;
    if (i == j || test::RadiusBeside(map, center, j) < options.clearance - 1e-9) fits = false;
  });
  return fits;
}

void ExpectSameAsBruteForce(const PlanningMap& map, const Reference& reference) {
  std::size_t traversable = 0;
  for (const auto& [i, state] : reference) {
    if (map.options().bounds && !map.box().Contains(i)) continue;
    // Above or below the band, a plane keeps only voxels between the band and its camera.
    const int up = map.EyeOf({0, 0, 0}).z;
    bool kept = !map.plane();
    for (int by = std::min(0, up); by <= std::max(0, up); ++by) {
      const VoxelIndex swept{i.x, i.y, i.z - by};
      kept |= std::isfinite(test::RadiusBeside(map, map.CenterOf(swept), swept));
    }
    ASSERT_EQ(map.State(i), kept ? state : VoxelState::kUnknown);
    const bool expected = BruteTraversable(reference, map, i);
    ASSERT_EQ(map.Traversable(i), expected) << i.x << ' ' << i.y << ' ' << i.z;
    traversable += expected ? 1U : 0U;
  }
  EXPECT_EQ(map.traversable_count(), traversable);
  EXPECT_EQ(test::TraversableVoxels(map).size(), traversable);
}

/// Applies the same random changes to a map and to the reference.
void ApplyRandomChanges(PlanningMap& map, Reference& reference, const VoxelBox& where, int batches,
                        std::mt19937& random) {
  for (int batch = 0; batch < batches; ++batch) {
    std::vector<VoxelChange> changes;
    if (batch == 0) changes = test::BoxOf(where, VoxelState::kFree);
    for (int n = 0; n < 12; ++n) {
      const int kind = RandomInt(random, 0, 9);
      const VoxelState state = kind < 6   ? VoxelState::kFree
                               : kind < 8 ? VoxelState::kOccupied
                                          : VoxelState::kUnknown;
      changes.push_back({test::RandomVoxel(random, where), test::LogOddsOf(state)});
    }
    Reference before = reference;
    for (const VoxelChange& change : changes) {
      reference[change.voxel] = OccupancyGrid::StateOf(change.log_odds);
    }
    for (const PlanningMap::StateChange& change : map.Apply(changes)) {
      EXPECT_NE(change.before, change.now);
      EXPECT_EQ(change.before, StateIn(before, change.voxel));
      before[change.voxel] = change.now;
    }
    ExpectSameAsBruteForce(map, reference);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(PlanningMap, TraversableEqualsBruteForceWithinBounds) {
  for (const double clearance : {0.04, 0.13, 0.15, 0.25}) {
    std::mt19937 random(7);
    PlanningMap map({.voxel_size = kSize, .clearance = clearance, .bounds = kBounds});
    Reference reference;
    ApplyRandomChanges(map, reference, {{-8, -5, -3}, {12, 16, 15}}, 5, random);
    ASSERT_FALSE(HasFatalFailure()) << clearance;
    EXPECT_GT(map.traversable_count(), 0U);
  }
}

TEST(PlanningMap, UprightCylindersFitWhereBruteForceSays) {
  for (const double half_height : {0.03, 0.1, 0.22, 0.35}) {
    for (const bool bounded : {true, false}) {
      std::mt19937 random(10);
      PlanningMap map({.voxel_size = kSize,
                       .clearance = 0.13,
                       .half_height = half_height,
                       .bounds = bounded ? std::optional(kBounds) : std::nullopt});
      Reference reference;
      ApplyRandomChanges(map, reference, {{-8, -5, -3}, {12, 16, 15}}, 4, random);
      ASSERT_FALSE(HasFatalFailure()) << half_height << ' ' << bounded;
      EXPECT_GT(map.traversable_count(), 0U);
    }
  }
}

TEST(PlanningMap, ARobotThatDrivesFitsWhereNothingInItsBandIsInItsWay) {
  for (const auto& [half_height, camera_height] :
       {std::pair{0.05, 0.0}, {0.1, 0.6}, {0.17, -0.4}, {0.25, 0.0}}) {
    for (const bool bounded : {true, false}) {
      std::mt19937 random(11);
      PlanningMap map({.voxel_size = kSize,
                       .clearance = 0.13,
                       .half_height = half_height,
                       .bounds = bounded ? std::optional(kBounds) : std::nullopt,
                       .camera_height = camera_height});
      Reference reference;
      ApplyRandomChanges(map, reference, {{-8, -5, -3}, {12, 16, 15}}, 2, random);
      map.SetPlane(0.53);
      ExpectSameAsBruteForce(map, reference);
      ApplyRandomChanges(map, reference, {{-8, -5, -3}, {12, 16, 15}}, 3, random);
      ASSERT_FALSE(HasFatalFailure()) << half_height << ' ' << bounded;
      EXPECT_GT(map.traversable_count(), 0U);
    }
  }
}

TEST(PlanningMap, TheBandOfARobotThatDrivesEndsAtTheVoxelsThatItTouches) {
  // From 0.15 to 0.55 m: layers 1 to 5. A cylinder that ends at a voxel's face does not touch it.
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .half_height = 0.2, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {20, 20, 20}}, VoxelState::kFree));
  map.SetPlane(0.35);
  EXPECT_FALSE(map.InBounds({5, 5, 0}));
  EXPECT_TRUE(map.InBounds({5, 5, 1}));
  EXPECT_TRUE(map.InBounds({5, 5, 5}));
  EXPECT_FALSE(map.InBounds({5, 5, 6}));
  EXPECT_TRUE(map.Traversable({5, 5, 3}));
  EXPECT_FALSE(map.Traversable({5, 5, 4})) << "of another layer";
  map.Apply(test::BoxOf({{5, 5, 0}, {6, 6, 1}}, VoxelState::kOccupied));
  EXPECT_TRUE(map.Traversable({5, 5, 3})) << "below it";
  map.Apply(test::BoxOf({{5, 5, 1}, {6, 6, 2}}, VoxelState::kOccupied));
  EXPECT_FALSE(map.Traversable({5, 5, 3}));
  EXPECT_FALSE(map.Traversable({6, 5, 3})) << "0.05 m beside it";
  EXPECT_TRUE(map.Traversable({7, 5, 3})) << "0.15 m";
  EXPECT_NEAR(map.ClearanceAt({0.85, 0.55, 0.35}, Obstacles::kOccupied, 1.0), 0.25, 1e-9);
  EXPECT_TRUE(map.SegmentClear({0.75, 0.2, 0.35}, {0.75, 1.5, 0.35}, Obstacles::kOccupied, 0.15));
  EXPECT_FALSE(map.SegmentClear({0.74, 0.2, 0.35}, {0.74, 1.5, 0.35}, Obstacles::kOccupied, 0.15));
  map.Reset();
  EXPECT_TRUE(map.plane());
}

TEST(PlanningMap, TheEyeIsWhereTheCameraIs) {
  for (const double camera_height : {0.0, 0.04, 0.06, 0.5, -0.33}) {
    PlanningMap map({.voxel_size = kSize,
                     .clearance = 0.15,
                     .half_height = 0.2,
                     .bounds = {},
                     .camera_height = camera_height});
    for (const bool drives : {false, true}) {
      if (drives) map.SetPlane(0.36);
      const double z = drives ? 0.36 : 0.35;
      const VoxelIndex body{7, 8, 3};
      const Eigen::Vector3d eye_W = map.EyeAt(map.CenterOf(body));
      EXPECT_NEAR((eye_W - Eigen::Vector3d(0.75, 0.85, z + camera_height)).norm(), 0.0, 1e-12);
      EXPECT_EQ(map.EyeOf(body), map.IndexOf(eye_W)) << camera_height;
      EXPECT_EQ(map.BodyOf(map.EyeOf(body)), body);
    }
  }
}

TEST(PlanningMap, ACameraAboveTheBandLooksOverWhatIsInIt) {
  for (const bool bounded : {true, false}) {
    const Eigen::AlignedBox3d low(Eigen::Vector3d::Zero(), Eigen::Vector3d(2.0, 2.0, 0.6));
    PlanningMap map({.voxel_size = kSize,
                     .clearance = 0.15,
                     .half_height = 0.2,
                     .bounds = bounded ? std::optional(low) : std::nullopt,
                     .camera_height = 0.6});
    for (int again = 0; again < 2; ++again) {  // values received before it knew its plane, and after
      map.Apply(test::BoxOf({{0, 0, 0}, {20, 20, 20}}, VoxelState::kFree));
      map.Apply(test::BoxOf({{10, 0, 0}, {11, 20, 7}}, VoxelState::kOccupied));
      map.Apply(test::BoxOf({{15, 5, 7}, {16, 6, 9}}, VoxelState::kOccupied));
      map.SetPlane(0.35);
      const Eigen::Vector3d here_W(0.55, 0.55, 0.35);
      const Eigen::Vector3d beyond_W(1.85, 0.55, 0.55);
      EXPECT_FALSE(map.InSight(here_W, beyond_W));
      EXPECT_TRUE(map.InSight(map.EyeAt(here_W), beyond_W));
      EXPECT_TRUE(map.Traversable({15, 5, 3})) << "under what hangs over the band";
      EXPECT_FALSE(map.InBounds({15, 5, 9})) << "it is looked through, not explored";
      map.Reset();
    }
  }
}

TEST(PlanningMap, WhatTheRobotFillsIsFreeAsFarAsNothingElseIsKnownOfIt) {
  const Eigen::Vector3d here_W(0.93, 0.52, 0.61);
  const VoxelIndex hit{10, 5, 6};
  for (const double half_height : {0.0, 0.32}) {
    for (const bool bounded : {true, false}) {
      PlanningMap map({.voxel_size = kSize,
                       .clearance = 0.3,
                       .half_height = half_height,
                       .bounds = bounded ? std::optional(kBounds) : std::nullopt});
      map.Apply(test::BoxOf({hit, hit + VoxelIndex{1, 1, 1}}, VoxelState::kOccupied));
      const std::size_t changed = map.Vacate(here_W, 0.25).size();
      std::size_t free = 0;
      test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
        const Eigen::Vector3d off = map.CenterOf(i) - here_W;
        const bool fills = half_height == 0.0
                               ? off.norm() <= 0.25
                               : std::hypot(off.x(), off.y()) <= 0.25 && std::abs(off.z()) <= half_height;
        EXPECT_EQ(map.State(i), i == hit ? VoxelState::kOccupied
                                : fills  ? VoxelState::kFree
                                         : VoxelState::kUnknown);
        free += fills && i != hit ? 1U : 0U;
      });
      EXPECT_EQ(changed, free);
      EXPECT_GT(changed, 20U);
      EXPECT_TRUE(map.Vacate(here_W, 0.25).empty()) << "once";
    }
  }
}

TEST(PlanningMap, OnlyACylinderCanDrive) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  EXPECT_THROW(map.SetPlane(0.3), std::invalid_argument);
}

const std::vector<Eigen::AlignedBox3d> kNoGo = {
    {Eigen::Vector3d(0.15, -1.0, 0.0), Eigen::Vector3d(0.3, 0.35, 2.0)},
    {Eigen::Vector3d(0.55, 0.82, 0.71), Eigen::Vector3d(0.58, 0.85, 0.74)}};

TEST(PlanningMap, TraversableEqualsBruteForceAroundNoGoBoxes) {
  for (const bool bounded : {true, false}) {
    std::mt19937 random(9);
    PlanningMap map({.voxel_size = kSize,
                     .clearance = 0.13,
                     .bounds = bounded ? std::optional(kBounds) : std::nullopt,
                     .no_go = kNoGo});
    Reference reference;
    ApplyRandomChanges(map, reference, {{-8, -5, -3}, {12, 16, 15}}, 5, random);
    ASSERT_FALSE(HasFatalFailure()) << bounded;
    EXPECT_GT(map.traversable_count(), 0U);
  }
}

TEST(PlanningMap, NoGoBoxesStopTheBodyAndNotTheEye) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.13, .bounds = {}, .no_go = kNoGo});
  map.Apply(test::BoxOf({{-10, -10, -10}, {20, 20, 20}}, VoxelState::kFree));
  const Eigen::Vector3d left(-0.2, 0.1, 0.5), right(0.7, 0.1, 0.5);
  EXPECT_TRUE(map.InSight(left, right));
  EXPECT_FALSE(map.SegmentClear(left, right, Obstacles::kOccupied, 0.13));
  EXPECT_TRUE(map.SegmentClear({-0.2, 0.7, 0.5}, {0.4, 0.7, 0.5}, Obstacles::kOccupiedAndUnknown, 0.13));
  EXPECT_NEAR(map.ClearanceAt({0.0, 0.1, 0.5}, Obstacles::kOccupied, 0.5), 0.1, 1e-9)
      << "to the voxel's face";
  EXPECT_FALSE(map.InBounds({2, 1, 5}));
  EXPECT_TRUE(map.InBounds({4, 1, 5}));
}

TEST(PlanningMap, TraversableEqualsBruteForceWhileTheMapGrows) {
  for (const double clearance : {0.13, 0.2}) {
    std::mt19937 random(8);
    PlanningMap map({.voxel_size = kSize, .clearance = clearance, .bounds = {}});
    Reference reference;
    for (const VoxelIndex& at : {VoxelIndex{0, 0, 0}, VoxelIndex{25, -3, 4}, VoxelIndex{-60, 8, -35}}) {
      ApplyRandomChanges(map, reference, {at, at + VoxelIndex{10, 9, 8}}, 2, random);
      ASSERT_FALSE(HasFatalFailure()) << clearance;
    }
    EXPECT_GT(map.traversable_count(), 0U);
  }
}

TEST(PlanningMap, WithLessClearanceItIsTheMapOfASlimmerBody) {
  for (const double half_height : {0.0, 0.17}) {
    for (const bool driving : {false, true}) {
      if (driving && half_height == 0.0) continue;
      std::mt19937 random(12);
      PlanningMap::Options options{
          .voxel_size = kSize, .clearance = 0.25, .half_height = half_height, .bounds = {}, .no_go = kNoGo};
      PlanningMap wide(options);
      options.clearance = 0.13;
      PlanningMap slim(options);
      for (PlanningMap* map : {&wide, &slim}) {
        if (driving) map->SetPlane(0.45);
        map->Apply(test::RandomScene(random, {{-8, -5, -3}, {12, 16, 15}}, 12, 4));
        random.seed(12);
      }
      const PlanningMap slimmed = wide.WithClearance(0.13);
      EXPECT_EQ(slimmed.traversable_count(), slim.traversable_count());
      EXPECT_GT(slimmed.traversable_count(), wide.traversable_count());
      for (const VoxelIndex& i : test::TraversableVoxels(slim)) ASSERT_TRUE(slimmed.Traversable(i));
      test::ForEachVoxel(wide.box(),
                         [&](const VoxelIndex& i) { ASSERT_EQ(slimmed.State(i), wide.State(i)); });
    }
  }
}

TEST(PlanningMap, NeighborsOfTraversableVoxelsAreInsideTheBox) {
  std::mt19937 random(9);
  PlanningMap map({.voxel_size = kSize, .clearance = 0.04, .bounds = {}});
  for (int n = 0; n < 30; ++n) {
    const VoxelIndex at = test::RandomVoxel(random, {{-90, -90, -90}, {90, 90, 90}});
    map.Apply(test::BoxOf({at, at + VoxelIndex{2, 2, 2}}, VoxelState::kFree));
  }
  const VoxelIndex one{1, 1, 1};
  const VoxelBox inside{map.box().min + one, map.box().max - one};
  for (const VoxelIndex& i : test::TraversableVoxels(map)) EXPECT_TRUE(inside.Contains(i));
}

TEST(PlanningMap, ResetIsBackToKnowingNothing) {
  for (const auto& bounds : {std::optional(kBounds), std::optional<Eigen::AlignedBox3d>()}) {
    std::mt19937 random(10);
    PlanningMap map({.voxel_size = kSize, .clearance = 0.13, .bounds = bounds});
    Reference reference;
    ApplyRandomChanges(map, reference, {{-2, 1, 3}, {7, 10, 9}}, 2, random);
    map.Reset();
    EXPECT_EQ(map.traversable_count(), 0U);
    for (const auto& [i, state] : reference) {
      EXPECT_EQ(map.State(i), VoxelState::kUnknown);
      EXPECT_FALSE(map.Traversable(i));
    }
    reference.clear();
    ApplyRandomChanges(map, reference, {{-2, 1, 3}, {7, 10, 9}}, 2, random);
  }
}

TEST(PlanningMap, BoundsHoldTheVoxelsWhoseCentersTheyHold) {
  const PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = kBounds});
  test::ForEachVoxel({{-12, -12, -12}, {16, 16, 16}}, [&](const VoxelIndex& i) {
    EXPECT_EQ(map.InBounds(i), kBounds.exteriorDistance(VoxelCenter(i, kSize)) <= 1e-9);
  });
}

TEST(PlanningMap, BadOptionsAreRefused) {
  EXPECT_THROW(PlanningMap({.voxel_size = 0.0, .clearance = 0.1, .bounds = {}}), std::invalid_argument);
  EXPECT_THROW(PlanningMap({.voxel_size = 0.1, .clearance = 0.0, .bounds = {}}), std::invalid_argument);
  const Eigen::AlignedBox3d empty(Eigen::Vector3d(0.01, 0, 0), Eigen::Vector3d(0.02, 1, 1));
  EXPECT_THROW(PlanningMap({.voxel_size = 0.1, .clearance = 0.1, .bounds = empty}), std::invalid_argument);
}

/// The same changes to a map with doubt and to one without, and the log odds of each voxel.
TEST(PlanningMap, DoubtfulAreTheKnownVoxelsOfLogOddsNearZero) {
  constexpr double kMaxLogOdds = 0.35;
  for (const bool bounded : {true, false}) {
    const PlanningMap::Options options{.voxel_size = kSize,
                                       .clearance = 0.13,
                                       .half_height = 0.2,
                                       .bounds = bounded ? std::optional(kBounds) : std::nullopt};
    PlanningMap::Options doubting = options;
    doubting.doubt = {.max_log_odds = kMaxLogOdds};
    PlanningMap plain(options);
    PlanningMap map(doubting);
    std::mt19937 random(12);
    std::unordered_map<VoxelIndex, float, VoxelIndexHash> reference;
    const auto is_doubtful = [&](const VoxelIndex& i) {
      const auto found = reference.find(i);
      return found != reference.end() && std::abs(found->second) < kMaxLogOdds;
    };
    const auto expect_as_reference = [&] {
      test::ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
        ASSERT_EQ(map.Doubtful(i), map.State(i) != VoxelState::kUnknown && is_doubtful(i));
        ASSERT_EQ(map.State(i), plain.State(i));
        ASSERT_EQ(map.Traversable(i), plain.Traversable(i));
      });
    };
    for (int batch = 0; batch < 12; ++batch) {
      if (batch == 4 || batch == 8) {  // known from elsewhere, and on a plane
        const VoxelIndex far{batch * 10, 0, 4};
        const VoxelChange change{far, 0.1F};
        map.Apply({&change, 1});
        plain.Apply({&change, 1});
        if (map.box().Contains(far)) reference[far] = 0.1F;
      }
      if (batch == 6) {
        map.SetPlane(0.53);
        plain.SetPlane(0.53);
      }
      std::vector<VoxelChange> changes;
      std::set<std::array<int, 3>> once;
      for (int n = 0; n < 300; ++n) {
        const VoxelIndex i = test::RandomVoxel(random, {{-5, -2, 0}, {9, 13, 12}});
        if (!once.insert({i.x, i.y, i.z}).second) continue;
        const bool unknown = random() % 10 == 0;
        changes.push_back({i, unknown ? OccupancyGrid::kUnknown
                                      : static_cast<float>(test::RandomDouble(random, -1.0, 1.0))});
      }
      plain.Apply(changes);
      const auto before = reference;
      for (const VoxelChange& change : changes) {
        if (bounded ? map.box().Contains(change.voxel) : true) reference[change.voxel] = change.log_odds;
      }
      for (const PlanningMap::StateChange& change : map.Apply(changes)) {
        const auto was = before.find(change.voxel);
        const bool doubted = was != before.end() && std::abs(was->second) < kMaxLogOdds;
        EXPECT_EQ(change.doubtful_now, is_doubtful(change.voxel));
        if (!map.plane()) {
          EXPECT_EQ(change.doubtful_before, doubted);
        }
        EXPECT_TRUE(change.before != change.now || change.doubtful_before != change.doubtful_now);
      }
      expect_as_reference();
      if (testing::Test::HasFatalFailure()) return;
    }
    EXPECT_EQ(plain.doubtful().size(), 0U);
    map.Reset();
    test::ForEachVoxel({{-5, -2, 0}, {9, 13, 12}},
                       [&](const VoxelIndex& i) { EXPECT_FALSE(map.Doubtful(i)); });
  }
}

TEST(PlanningMap, WhatTheBodyFillsIsFreeForSure) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}, .doubt = {.max_log_odds = 5.0}});
  map.Vacate({0.5, 0.5, 0.5}, 0.2);
  EXPECT_EQ(map.State({4, 4, 4}), VoxelState::kFree);
  EXPECT_FALSE(map.Doubtful({4, 4, 4}));
}

TEST(PlanningMap, DoubtThatCannotBeIsRefused) {
  const auto with = [](const DoubtOptions& doubt) {
    return PlanningMap({.voxel_size = kSize, .clearance = 0.15, .bounds = {}, .doubt = doubt});
  };
  EXPECT_THROW(with({.max_log_odds = -0.1}), std::invalid_argument);
  EXPECT_THROW(with({.weight = 0.0}), std::invalid_argument);
  EXPECT_THROW(with({.weight = 1.01}), std::invalid_argument);
  EXPECT_NO_THROW(with({.max_log_odds = 0.3, .weight = 1.0}));
}

struct Body {
  double half_height;  // 0 = a sphere
  bool drives;
};

class RandomScenes : public testing::TestWithParam<std::tuple<unsigned, Body>> {
 protected:
  RandomScenes() {
    map_.Apply(test::RandomScene(random_, {{0, 0, 0}, {14, 14, 14}}, 10, 4));
    if (std::get<1>(GetParam()).drives) map_.SetPlane(0.7);
  }
  Eigen::Vector3d Point() {
    return test::RandomPoint(random_, {Eigen::Vector3d::Constant(-0.1), Eigen::Vector3d::Constant(1.5)});
  }

  std::mt19937 random_{std::get<0>(GetParam())};
  PlanningMap map_{{.voxel_size = kSize,
                    .clearance = 0.15,
                    .half_height = std::get<1>(GetParam()).half_height,
                    .bounds = {}}};
};
INSTANTIATE_TEST_SUITE_P(PlanningMap, RandomScenes,
                         testing::Combine(testing::Range(1U, 5U),
                                          testing::Values(Body{0.0, false}, Body{0.06, false},
                                                          Body{0.3, false}, Body{0.24, true})));

TEST(PlanningMap, AVoxelTooFarForItsLimitIsIgnoredAndCounted) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}, .max_voxels = 500'000});
  const VoxelChange near{{3, 3, 3}, test::kFreeLogOdds};
  map.Apply({&near, 1});
  const VoxelBox box = map.box();
  const VoxelChange far{{200'000, 3, 3}, test::kFreeLogOdds};
  EXPECT_TRUE(map.Apply({&far, 1}).empty());
  EXPECT_EQ(map.beyond_limit(), 1U);
  EXPECT_EQ(map.box(), box);
  EXPECT_EQ(map.State(near.voxel), VoxelState::kFree);
}

TEST(PlanningMap, AStrayVoxelDoesNotTakeTheRoomOfTheOthers) {
  std::vector<VoxelChange> changes{{{-32'760, 0, 0}, 1.0F}, {{32'760, 32'760, 0}, 1.0F}};  // come first
  ForEachVoxel({{0, 0, 0}, {120, 100, 20}}, [&](const VoxelIndex& i) {
    changes.push_back({i, test::kFreeLogOdds});
  });
  const PlanningMap::Options options{
      .voxel_size = kSize, .clearance = 0.15, .bounds = {}, .max_voxels = 2'000'000};
  PlanningMap fresh(options);
  EXPECT_EQ(fresh.Apply(changes).size(), 120U * 100U * 20U);
  EXPECT_EQ(fresh.beyond_limit(), 2U);
  EXPECT_LE(fresh.box().count(), options.max_voxels);

  PlanningMap grown(options);
  const VoxelChange seen{{30, 20, 10}, test::kFreeLogOdds};
  grown.Apply({&seen, 1});
  changes[0].voxel = {300, 20, 10};  // which alone would fit, but leave too little room for the others
  EXPECT_EQ(grown.Apply(changes).size(), 120U * 100U * 20U - 1U);
  EXPECT_EQ(grown.beyond_limit(), 2U);
}

TEST(PlanningMap, BoundsOfMoreVoxelsThanItsLimitAreRefused) {
  PlanningMap::Options options{.voxel_size = kSize, .clearance = 0.15, .bounds = {}, .max_voxels = 1000};
  options.bounds = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d(2.0, 2.0, 2.0));
  EXPECT_THROW(PlanningMap{options}, std::invalid_argument);
}

TEST_P(RandomScenes, ClearanceEqualsBruteForce) {
  for (int n = 0; n < 200; ++n) {
    const Eigen::Vector3d p_W = Point();
    for (const Obstacles obstacles :
         {Obstacles::kOccupied, Obstacles::kOccupiedAndUnknown, Obstacles::kAllButSurelyFree}) {
      EXPECT_NEAR(map_.ClearanceAt(p_W, obstacles, 0.45), test::BruteClearance(map_, p_W, obstacles, 0.45),
                  1e-12);
    }
  }
}

TEST(PlanningMap, WhatIsOnlyWeaklyFreeIsNotSurelyFree) {
  PlanningMap map({.voxel_size = kSize, .clearance = 0.15, .bounds = {}});
  map.Apply(test::BoxOf({{0, 0, 0}, {20, 11, 11}}, VoxelState::kFree));
  const auto clearance = [&map](Obstacles obstacles) {
    return map.ClearanceAt({1.05, 0.55, 0.55}, obstacles, 0.4);
  };
  const VoxelIndex beside{12, 5, 5};
  const auto set = [&](float log_odds) {
    const VoxelChange change{beside, log_odds};
    map.Apply({&change, 1});
  };
  set(OccupancyGrid::kWeaklyFree);
  EXPECT_NEAR(clearance(Obstacles::kAllButSurelyFree), 0.15, 1e-9);
  EXPECT_EQ(clearance(Obstacles::kOccupiedAndUnknown), 0.4) << "it may be gone through";
  map.Apply(test::BoxOf({{100, 0, 0}, {101, 1, 1}}, VoxelState::kFree));
  EXPECT_NEAR(clearance(Obstacles::kAllButSurelyFree), 0.15, 1e-9) << "also when the map has grown";
  set(-0.4F);
  EXPECT_EQ(clearance(Obstacles::kAllButSurelyFree), 0.4);
}

TEST_P(RandomScenes, SegmentsAreClearAsDenseSamplingSays) {
  int clear = 0;
  for (int n = 0; n < 300; ++n) {
    const Eigen::Vector3d a_W = Point();
    const Eigen::Vector3d b_W = n % 10 == 0 ? a_W : Eigen::Vector3d(a_W + 0.4 * (Point() - a_W));
    const double clearance = test::RandomDouble(random_, 0.02, 0.2);
    const Obstacles obstacles = n % 2 == 0 ? Obstacles::kOccupied : Obstacles::kOccupiedAndUnknown;
    const double sampled = test::SampledClearance(map_, {a_W, b_W}, obstacles, 0.3);
    // SegmentClear samples at a quarter of a voxel, so a dip of an eighth may escape it.
    if (map_.SegmentClear(a_W, b_W, obstacles, clearance)) {
      EXPECT_GE(sampled, clearance - kSize / 8 - 1e-6);
      ++clear;
    } else {
      EXPECT_LT(sampled, clearance + 0.001);
    }
    EXPECT_NEAR(map_.SegmentClearance(a_W, b_W, obstacles, 0.3), sampled, kSize / 16 + 0.001);
  }
  EXPECT_GT(clear, 10);
}

TEST_P(RandomScenes, InSightMeansThatNothingButFreeSpaceIsBetween) {
  int in_sight = 0;
  for (int n = 0; n < 200; ++n) {
    const Eigen::Vector3d a_W = Point();
    const Eigen::Vector3d b_W = Point();
    // Voxels whose interior the segment crosses. Those that it only grazes may be reported or not.
    std::set<std::array<int, 3>> between;
    const VoxelIndex first = map_.IndexOf(a_W);
    const VoxelIndex last = map_.IndexOf(b_W);
    for (int k = 0; k <= 4000; ++k) {
      const Eigen::Vector3d p_W = a_W + (b_W - a_W) * (k / 4000.0);
      const VoxelIndex i = map_.IndexOf(p_W);
      const double off_center = (p_W - map_.CenterOf(i)).cwiseAbs().maxCoeff();
      if (i == first || i == last || off_center > 0.5 * kSize - 1e-6) continue;
      between.insert({i.x, i.y, i.z});
    }
    const bool free = std::all_of(between.begin(), between.end(), [&](const auto& i) {
      return map_.State({i[0], i[1], i[2]}) == VoxelState::kFree;
    });
    if (map_.InSight(a_W, b_W)) {
      EXPECT_TRUE(free);
      ++in_sight;
    } else if (free) {
      // Only a corner cut too short for the samples may lie in between.
      bool touched = false;
      TraverseVoxels(a_W, b_W, kSize, [&](const VoxelIndex& i) {
        touched |= map_.State(i) != VoxelState::kFree && !between.contains({i.x, i.y, i.z});
        return true;
      });
      EXPECT_TRUE(touched);
    }
  }
  EXPECT_GT(in_sight, 5);
}

}  // namespace
}  // namespace thalweg::explorer
