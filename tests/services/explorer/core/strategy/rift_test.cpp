#include "services/explorer/core/strategy/rift.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <random>

#include "tests/common/surface_graph/scenes.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

using surface::test::Rig;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kRiftClearance = 0.15;
const StereoGeometry kRiftRig = Rig(160, 120, 110.0);

/// A robot whose body's axes are those of its camera, in a world that looks along z.
class RiftTest : public testing::Test {
 protected:
  /// Shows the strategy what a camera sees that stands in the robot.
  template <class DepthAlong>
  void See(DepthAlong&& depth_along) {
    DepthImage depth{kRiftRig.camera.width_px, kRiftRig.camera.height_px, {}};
    for (int v = 0; v < depth.height_px; ++v) {
      for (int u = 0; u < depth.width_px; ++u) {
        const Eigen::Vector3d ray_W = T_WB_.linear() * kRiftRig.camera.RayAtUnitDepth(u, v);
        const double z = depth_along(Eigen::Vector3d(T_WB_.translation()), ray_W);
        depth.depths.push_back(z < surface::test::kNothing ? static_cast<float>(z)
                                                           : std::numeric_limits<float>::quiet_NaN());
      }
    }
    seen_.push_back({.rig = kRiftRig,
                     .disparities = surface::DisparitiesOf(depth, kRiftRig),
                     .colors = {},
                     .T_WC = T_WB_});
    rift_.See({CloudFrom(depth, kRiftRig.camera), kRiftRig.camera, T_WB_, RigidTransform::Identity()});
  }
  void Know(const VoxelBox& box, VoxelState state) { map_.Apply(test::BoxOf(box, state)); }
  void KnowThatAllIsFree() { Know({{-60, -40, -20}, {60, 40, 60}}, VoxelState::kFree); }

  std::vector<Candidate> Find(bool straight = true) {
    aside_ = DenseGrid<std::uint8_t>(map_.box(), 0);
    const PathSearch::Exemption exemption;
    return *rift_.FindCandidates({.map = map_,
                                  .robot_W = T_WB_.translation(),
                                  .clearance = kRiftClearance,
                                  .set_aside = aside_,
                                  .min_area = 0.0,
                                  .radius = 0.1,
                                  .exemptions = {&exemption, 1},
                                  .pull_straight = straight});
  }
  Choice ChooseAmong(const std::vector<Candidate>& candidates) {
    return rift_.Choose(
        {map_, search_, T_WB_.translation(), kRiftClearance, candidates, test::kViews, 3.0, 3.0});
  }
  /// Goes where the strategy wants to, and looks. @return Whether it wants to go anywhere.
  template <class DepthAlong>
  bool GoOn(DepthAlong&& depth_along) {
    const std::vector<Candidate> candidates = Find();
    if (candidates.empty()) return false;
    const Choice choice = ChooseAmong(candidates);
    EXPECT_EQ(choice.path_W.front(), T_WB_.translation());
    for (std::size_t n = 1; n < choice.path_W.size(); ++n) {
      EXPECT_TRUE(map_.SegmentClear(choice.path_W[n - 1], choice.path_W[n],
                                    PlanningMap::Obstacles::kOccupiedAndUnknown, 0.125));
    }
    T_WB_ = MakeTransform(*choice.R_WB, choice.path_W.back());
    See(depth_along);
    return true;
  }
  /// The poses to look from in the next move, by the graph of what was seen.
  std::vector<surface::CameraPose> NextPoses(int views = 4) const {
    surface::Surface surface({});
    for (const surface::View& view : seen_) surface.Add(view);
    return surface::PosesToLookFrom(surface.PlanMove().poses, views);
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = kRiftClearance, .bounds = {}}};
  PathSearch search_;
  DenseGrid<std::uint8_t> aside_;
  RigidTransform T_WB_ = surface::test::Shifted({-1.0, 0.0, 0.0});  ///< Beside the step.
  Rift rift_{{}};
  std::vector<surface::View> seen_;
};

double Plane(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& ray_W) {
  return surface::test::PlaneAt(3.0, origin_W, ray_W);
}

TEST_F(RiftTest, NeedsAViewFirst) {
  EXPECT_TRUE(rift_.goes_by_views());
  EXPECT_TRUE(rift_.lacks_view());
  See(surface::test::StepAt);
  EXPECT_FALSE(rift_.lacks_view());
}

TEST_F(RiftTest, LooksFromAboveTheWayToTheDominantRiftAtTheStatedHeight) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  const std::vector<surface::CameraPose> poses = NextPoses();
  ASSERT_THAT(poses, SizeIs(4));
  for (const surface::CameraPose& pose : poses) {
    const std::vector<Candidate> candidates = Find();
    ASSERT_THAT(candidates, SizeIs(1));
    const Choice choice = ChooseAmong(candidates);
    ASSERT_TRUE(choice.R_WB);
    EXPECT_TRUE(choice.R_WB->isApprox(pose.T_WC.linear()));
    EXPECT_TRUE(choice.path_W.back().isApprox(pose.T_WC.translation()));
    const Eigen::Vector3d& above_W = candidates[0].cluster.center_W;
    EXPECT_NEAR((choice.path_W.back() - above_W).norm(), 1.0, 1e-6);
    EXPECT_TRUE(choice.R_WB->col(2).isApprox(above_W - choice.path_W.back(), 1e-6)) << "back at the surface";
    T_WB_ = pose.T_WC;
    See(surface::test::StepAt);
  }
  EXPECT_EQ(rift_.surface().views().size(), 5U);
  EXPECT_EQ(rift_.left_out(), 0U);
  EXPECT_THAT(rift_.TakeNotes(), IsEmpty());
}

TEST_F(RiftTest, FollowsTheTrajectoryAndStraightensItIfPathsAre) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  const std::vector<Candidate> candidates = Find(/*straight=*/false);
  const Choice along = ChooseAmong(candidates);
  const Choice straight = ChooseAmong(Find(/*straight=*/true));
  EXPECT_GT(along.path_W.size(), 5U);
  EXPECT_EQ(straight.path_W, (std::vector<Eigen::Vector3d>{along.path_W.front(), along.path_W.back()}));
  EXPECT_NEAR(candidates[0].length, PathLength(along.path_W), 1e-9);
}

TEST_F(RiftTest, PlansTheNextMoveByTheViewsOfTheLast) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  for (int n = 0; n < 4; ++n) ASSERT_TRUE(GoOn(surface::test::StepAt));
  const std::vector<surface::CameraPose> poses = NextPoses();
  const std::vector<Candidate> candidates = Find();
  ASSERT_FALSE(poses.empty());
  ASSERT_THAT(candidates, SizeIs(1));
  EXPECT_TRUE(ChooseAmong(candidates).path_W.back().isApprox(poses[0].T_WC.translation()));
}

TEST_F(RiftTest, DoesNotGoBackAlongTheTrajectory) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  surface::Surface surface({});
  surface.Add(seen_.back());
  const std::vector<surface::CameraPose> poses = surface.PlanMove().poses;
  const std::vector<std::size_t> stops = surface::PlacesToLookFrom(poses.size(), 4);
  ASSERT_TRUE(GoOn(surface::test::StepAt));
  const Choice choice = ChooseAmong(Find(/*straight=*/false));
  ASSERT_GT(choice.path_W.size(), 2U);
  for (std::size_t n = 1; n < choice.path_W.size(); ++n) {
    const auto at = std::ranges::find_if(poses, [&](const surface::CameraPose& pose) {
      return pose.T_WC.translation().isApprox(choice.path_W[n]);
    });
    EXPECT_GT(at - poses.begin(), static_cast<std::ptrdiff_t>(stops[0])) << n;
    EXPECT_LE(at - poses.begin(), static_cast<std::ptrdiff_t>(stops[1])) << n;
  }
}

TEST_F(RiftTest, LooksFromEachPoseOnceWhereThereAreFewerThanViews) {
  KnowThatAllIsFree();
  rift_ = Rift({.surface = {}, .views_per_move = 1000, .most_views = 2000});
  See(surface::test::StepAt);
  surface::Surface surface({});
  surface.Add(seen_.back());
  const std::size_t poses = surface.PlanMove().poses.size();
  ASSERT_LT(poses, 1000U);
  Eigen::Vector3d before_W = T_WB_.translation();
  for (std::size_t n = 0; n < std::min<std::size_t>(poses, 8); ++n) {
    ASSERT_TRUE(GoOn(surface::test::StepAt));
    EXPECT_GT((T_WB_.translation() - before_W).norm(), 1e-6) << n;
    before_W = T_WB_.translation();
  }
}

TEST_F(RiftTest, AmongObstaclesTheWayKeepsItsDistanceAndEndsWhereTheBodyCanStand) {
  int found = 0;
  int direct = 0;
  std::vector<std::string> notes;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    map_ = PlanningMap({.voxel_size = 0.1,
                        .clearance = kRiftClearance,
                        .bounds = Eigen::AlignedBox3d(Eigen::Vector3d(-2.0, -1.0, -2.0),
                                                      Eigen::Vector3d(seed % 4 == 0 ? 0.0 : 3.0, 1.0, 4.0))});
    KnowThatAllIsFree();
    std::uniform_int_distribution<int> x(-20, 20), y(-6, 6), z(-4, 22);
    for (int n = 0; n < 120; ++n) {
      const VoxelIndex i{x(random), y(random), z(random)};
      Know({i, i + VoxelIndex{1, 1, 1}}, n % 4 == 0 ? VoxelState::kUnknown : VoxelState::kOccupied);
    }
    rift_ = Rift({});
    T_WB_ = surface::test::Shifted({-1.0, 0.0, 0.0});
    See(surface::test::StepAt);
    const std::vector<Candidate> candidates = Find(/*straight=*/false);
    for (std::string& note : rift_.TakeNotes()) notes.push_back(std::move(note));
    if (candidates.empty()) continue;
    ++found;
    constexpr auto kAll = PlanningMap::Obstacles::kOccupiedAndUnknown;
    const Choice choice = ChooseAmong(candidates);
    const bool is_free = map_.SegmentClear(choice.path_W[0], choice.path_W[0], kAll, 0.125);
    direct += is_free ? 1 : 0;
    for (std::size_t n = 1; n < choice.path_W.size(); ++n) {
      const Eigen::Vector3d& p_W = choice.path_W[n];
      if (n > 1 || is_free) {
        EXPECT_TRUE(map_.SegmentClear(choice.path_W[n - 1], p_W, kAll, 0.125)) << seed << ' ' << n;
        EXPECT_TRUE(map_.SegmentClear(p_W, p_W, kAll, kRiftClearance)) << seed << ' ' << n;
      }
      EXPECT_TRUE(map_.InBounds(map_.IndexOf(p_W))) << seed << ' ' << n;
    }
  }
  EXPECT_GT(found, 10);
  EXPECT_GT(direct, 5);
  EXPECT_THAT(notes, testing::Contains(HasSubstr("it is outside of what is to be explored")));
  EXPECT_LT(direct, found) << "in some the robot stands too near to something";
}

TEST_F(RiftTest, AViewThatShowsNothingIsNotKeptAndNamed) {
  KnowThatAllIsFree();
  const auto nothing = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return surface::test::kNothing; };
  See(surface::test::StepAt);
  const std::vector<surface::CameraPose> poses = NextPoses();
  ASSERT_TRUE(GoOn(nothing));
  EXPECT_EQ(rift_.surface().views().size(), 1U);
  EXPECT_THAT(rift_.TakeNotes(), testing::ElementsAre("view 1 of 4 of move 1 shows nothing"));
  EXPECT_TRUE(ChooseAmong(Find()).path_W.back().isApprox(poses[1].T_WC.translation())) << "it goes on";
}

TEST_F(RiftTest, EndsWhereItsViewsShowNothing) {
  KnowThatAllIsFree();
  const auto nothing = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return surface::test::kNothing; };
  See(nothing);
  EXPECT_FALSE(rift_.lacks_view()) << "another from here would show as little";
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_FALSE(rift_.end()->completes);
  EXPECT_EQ(rift_.end()->why, "the camera sees nothing from where the robot starts");
  rift_ = Rift({});
  See(surface::test::StepAt);
  for (int n = 0; n < 4; ++n) ASSERT_TRUE(GoOn(nothing));
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_FALSE(rift_.end()->completes);
  EXPECT_EQ(rift_.end()->why, "the camera sees nothing from any pose of the way to the dominant rift");
}

TEST_F(RiftTest, PosesInWhatIsNotKnownAsFreeAreLeftOutCountedAndSaid) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  const std::vector<surface::CameraPose> poses = NextPoses();
  const VoxelIndex first = map_.IndexOf(poses[0].T_WC.translation());
  const VoxelIndex last = map_.IndexOf(poses[3].T_WC.translation());
  Know({first, first + VoxelIndex{1, 1, 1}}, VoxelState::kOccupied);
  Know({last, last + VoxelIndex{1, 1, 1}}, VoxelState::kUnknown);
  for (const std::size_t n : {1U, 2U}) {
    ASSERT_TRUE(GoOn(surface::test::StepAt));
    EXPECT_TRUE(T_WB_.isApprox(poses[n].T_WC));
  }
  EXPECT_EQ(rift_.left_out(), 1U);
  Find();
  EXPECT_GE(rift_.left_out(), 2U) << "and what the next move adds";
  const std::vector<std::string> notes = rift_.TakeNotes();
  ASSERT_EQ(notes.size(), rift_.left_out());
  EXPECT_EQ(notes[0], "view 1 of 4 of move 1 is left out: the body would touch something");
  EXPECT_EQ(notes[1], "view 4 of 4 of move 1 is left out: the body would reach into what is not known");
  EXPECT_THAT(rift_.TakeNotes(), IsEmpty()) << "each once";
}

TEST_F(RiftTest, WhatNoFreeWayLeadsToIsLeftOut) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  // A closed shell around the robot
  const VoxelBox shell{{-16, -6, -6}, {-4, 6, 6}};
  std::vector<VoxelChange> walls = test::BoxOf(shell, VoxelState::kOccupied);
  std::erase_if(walls, [](const VoxelChange& wall) {
    return VoxelBox{{-15, -5, -5}, {-5, 5, 5}}.Contains(wall.voxel);
  });
  map_.Apply(walls);
  EXPECT_THAT(Find(), IsEmpty());
  const std::vector<std::string> notes = rift_.TakeNotes();
  ASSERT_THAT(notes, SizeIs(4));
  EXPECT_THAT(notes, testing::Contains(HasSubstr("no part of the trajectory leads there")));
}

TEST_F(RiftTest, EndsWhereEveryPoseOfAMoveIsLeftOut) {
  Know({{-14, -4, -4}, {-6, 4, 4}}, VoxelState::kFree);
  See(surface::test::StepAt);
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_FALSE(rift_.end()->completes);
  EXPECT_EQ(rift_.end()->why, "no pose of the way to the dominant rift is possible");
  EXPECT_EQ(rift_.left_out(), 4U);
}

TEST_F(RiftTest, IsCompleteWhereNoRiftIsLeft) {
  KnowThatAllIsFree();
  See(Plane);
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_TRUE(rift_.end()->completes);
  EXPECT_EQ(rift_.end()->why, "no rift is left");
}

TEST_F(RiftTest, EndsWhereNoPathOverTheSurfaceLeadsToARift) {
  KnowThatAllIsFree();
  // Between what the camera looks at and the step nothing was measured.
  See([](const Eigen::Vector3d& origin_W, const Eigen::Vector3d& ray_W) {
    if (ray_W.x() > 0.2 && ray_W.x() < 0.3) return surface::test::kNothing;
    return ray_W.x() < 0.5 ? Plane(origin_W, ray_W) : surface::test::PlaneAt(4.0, origin_W, ray_W);
  });
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_FALSE(rift_.end()->completes);
  EXPECT_EQ(rift_.end()->why, "no path over the surface leads to a rift");
}

TEST_F(RiftTest, EndsWhereTheDominantRiftHasNoNormal) {
  KnowThatAllIsFree();
  // Two pixels only: a rift of one edge spans no plane.
  See([pixel = 0](const Eigen::Vector3d&, const Eigen::Vector3d&) mutable {
    const int middle = 60 * 160 + 80;
    ++pixel;
    return pixel == middle ? 2.0 : pixel == middle + 1 ? 3.0 : surface::test::kNothing;
  });
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_FALSE(rift_.end()->completes);
  EXPECT_EQ(rift_.end()->why, "the dominant rift has no normal along which to look");
}

TEST_F(RiftTest, EndsWhereItKeepsAsManyViewsAsItMay) {
  KnowThatAllIsFree();
  rift_ = Rift({.surface = {}, .most_views = 2});
  See(surface::test::StepAt);
  EXPECT_TRUE(GoOn(surface::test::StepAt));
  EXPECT_THAT(Find(), IsEmpty());
  ASSERT_TRUE(rift_.end());
  EXPECT_FALSE(rift_.end()->completes);
  EXPECT_THAT(rift_.end()->why, HasSubstr("2 views"));
  EXPECT_THAT(rift_.end()->why, HasSubstr("most_views"));
}

TEST_F(RiftTest, APoseThatTheRobotDoesNotGetToIsLeftOut) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  const std::vector<surface::CameraPose> poses = NextPoses();
  for (int n = 0; n < Rift::kMostTries; ++n)
    EXPECT_TRUE(ChooseAmong(Find()).path_W.back().isApprox(poses[0].T_WC.translation()));
  EXPECT_EQ(rift_.left_out(), 0U);
  EXPECT_TRUE(ChooseAmong(Find()).path_W.back().isApprox(poses[1].T_WC.translation()));
  EXPECT_EQ(rift_.left_out(), 1U);
  EXPECT_THAT(rift_.TakeNotes(), testing::ElementsAre(HasSubstr("did not get there in 3 tries")));
}

TEST_F(RiftTest, ARobotThatIsStoppedOnItsWayGetsThereInTheEnd) {
  KnowThatAllIsFree();
  See(surface::test::StepAt);
  const Eigen::Vector3d goal_W = NextPoses()[3].T_WC.translation();
  rift_ = Rift({.surface = {}, .views_per_move = 1});
  See(surface::test::StepAt);
  const Eigen::Vector3d start_W = T_WB_.translation();
  for (int n = 0; n < 2 * Rift::kMostTries; ++n) {
    T_WB_.translation() = start_W + n / 10.0 * (goal_W - start_W);
    EXPECT_TRUE(ChooseAmong(Find()).path_W.back().isApprox(goal_W)) << n;
  }
  EXPECT_EQ(rift_.left_out(), 0U);
}

TEST_F(RiftTest, TheBodyStandsWhereItsCameraLooksFromThePose) {
  KnowThatAllIsFree();
  const RigidTransform T_BC = MakeTransform(BodyFromOptical(), Eigen::Vector3d(0.05, 0.0, 0.02));
  DepthImage depth{kRiftRig.camera.width_px, kRiftRig.camera.height_px, {}};
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      depth.depths.push_back(static_cast<float>(
          surface::test::StepAt(Eigen::Vector3d::Zero(), kRiftRig.camera.RayAtUnitDepth(u, v))));
    }
  }
  const surface::View view =
      surface::test::ViewOf(kRiftRig, RigidTransform::Identity(), surface::test::StepAt);
  seen_.push_back(view);
  rift_.See({CloudFrom(depth, kRiftRig.camera), kRiftRig.camera, T_BC.inverse(), T_BC});
  const Choice choice = ChooseAmong(Find());
  const RigidTransform T_WC = MakeTransform(*choice.R_WB, choice.path_W.back()) * T_BC;
  EXPECT_TRUE(T_WC.isApprox(NextPoses()[0].T_WC, 1e-5));
}

TEST(Rift, RefusesOptionsByName) {
  const auto refuses = [](const char* name, const std::function<void(Rift::Options&)>& change) {
    Rift::Options options;
    change(options);
    try {
      Rift rift(options);
      ADD_FAILURE() << name << " was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  };
  refuses("views_per_move", [](Rift::Options& options) { options.views_per_move = 0; });
  refuses("most_views", [](Rift::Options& options) { options.most_views = 0; });
  refuses("rift_edge", [](Rift::Options& options) { options.surface.rift_edge = 0.0; });
}

}  // namespace
}  // namespace thalweg::explorer
