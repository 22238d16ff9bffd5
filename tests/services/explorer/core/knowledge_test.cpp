#include "services/explorer/core/knowledge.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "common/base/angles.h"
#include "services/explorer/core/map/frontier.h"
#include "tests/services/explorer/support/knowing.h"
#include "tests/services/explorer/support/random_planning_map.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;

const RobotModel kRobot;

RigidTransform CameraAt(const RigidTransform& T_WB) {
  return T_WB * kRobot.T_BC;
}

/// Counts every look, from wherever it is.
Knowledge::Options CountingOptions() {
  Knowledge::Options options = test::KnowingOptions();
  options.memory = {.looks = 100, .apart = 0.0};
  return options;
}

class KnowledgeOfRandomMaps : public testing::TestWithParam<unsigned> {
 protected:
  KnowledgeOfRandomMaps() {
    knowledge_.Update(test::RandomScene(random_, {{0, 0, 0}, {34, 30, 22}}, 22, 8), {}, Time{});
    const std::vector<VoxelIndex> places = test::TraversableVoxels(map());
    const VoxelIndex place = places[random_() % places.size()];
    const Eigen::Matrix3d R_WB =
        RotationFromYawPitch(test::RandomDouble(random_, -3.1, 3.1), test::RandomDouble(random_, -1.0, 1.0));
    scan_.T_WC = CameraAt(MakeTransform(R_WB, map().CenterOf(place)));
  }
  const PlanningMap& map() const { return knowledge_.map(); }
  /// The pixel onto which a voxel projects, if the scan has it in its image.
  std::optional<Eigen::Vector2d> PixelOf(const VoxelIndex& i) const {
    return options_.camera.Project(scan_.T_WC.inverse() * map().CenterOf(i));
  }
  bool InViewOfScan(const VoxelIndex& i) const {
    const Eigen::Vector3d eye_W = scan_.T_WC.translation();
    return (map().CenterOf(i) - eye_W).norm() <= options_.look_range && PixelOf(i) &&
           map().InSight(eye_W, map().CenterOf(i));
  }
  void Scan() { knowledge_.Update({}, {&scan_, 1}, Time{1s}); }

  std::mt19937 random_{GetParam()};
  Knowledge::Options options_ = CountingOptions();
  Knowledge knowledge_{options_};
  ScanView scan_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, KnowledgeOfRandomMaps, testing::Range(1U, 11U));

TEST_P(KnowledgeOfRandomMaps, AScanIsALookAtEveryTargetInItsView) {
  Scan();
  test::ForEachVoxel(map().box(), [&](const VoxelIndex& i) {
    const bool looked = IsTarget(map(), i) && InViewOfScan(i);
    EXPECT_EQ(knowledge_.memory().Looks(i), looked ? 1 : 0);
  });
}

TEST_P(KnowledgeOfRandomMaps, WhereTheScanHadNoDepthALookSensedNothing) {
  options_.memory.looks = 1;  // set aside, with its reason, by the first
  Knowledge knowing(options_);
  std::vector<VoxelChange> changes;
  test::ForEachVoxel(map().box(), [&](const VoxelIndex& i) {
    if (map().State(i) != VoxelState::kUnknown) changes.push_back({i, test::LogOddsOf(map().State(i))});
  });
  knowing.Update(changes, {}, Time{});
  scan_.measured.emplace();  // the left half of the image
  constexpr int kSide = MeasuredShares::kSide;
  for (int k = 0; k < kSide * kSide; ++k) {
    scan_.measured->of_255[static_cast<std::size_t>(k)] = k % kSide < kSide / 2 ? 255 : 0;
  }
  knowing.Update({}, {&scan_, 1}, Time{1s});
  test::ForEachVoxel(map().box(), [&](const VoxelIndex& i) {
    const std::optional<Eigen::Vector2d> pixel = PixelOf(i);
    const bool is_left = pixel && pixel->x() + 0.5 < 0.5 * options_.camera.width_px;
    const std::optional<Sensed> sensed = knowing.LastSensed(i);
    EXPECT_EQ(sensed.has_value(), pixel.has_value());
    if (pixel) {
      EXPECT_EQ(sensed, is_left ? Sensed::kDepth : Sensed::kNothing);
    }
    if (!IsTarget(map(), i) || !InViewOfScan(i)) return;
    const AsideReason reason = is_left ? AsideReason::kLookedAt : AsideReason::kNoDepth;
    EXPECT_EQ(knowing.memory().set_aside()[i], static_cast<std::uint8_t>(reason));
  });
}

TEST_P(KnowledgeOfRandomMaps, NothingIsLeftAfterAReset) {
  scan_.measured.emplace();
  Scan();
  knowledge_.memory().SetAside({3, 3, 3}, AsideReason::kVisited, Time{1s});
  knowledge_.Reset();
  test::ForEachVoxel({{0, 0, 0}, {34, 30, 22}}, [&](const VoxelIndex& i) {
    EXPECT_EQ(map().State(i), VoxelState::kUnknown);
    EXPECT_FALSE(knowledge_.LastSensed(i));
  });
  EXPECT_TRUE(knowledge_.memory().SetAsideVoxels().empty());
}

TEST(Knowledge, AScanFromNearlyTheSamePoseShowsNothingNew) {
  Knowledge knowledge(CountingOptions());
  knowledge.Update(test::LongRoom({{0, 0, 0}, {20, 12, 12}}), {}, Time{});
  constexpr VoxelIndex kTarget{20, 6, 6};
  const auto looks_after = [&](double x, double yaw_deg) {
    const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(yaw_deg * kDegree, 0.0), {x, 0.65, 0.65});
    const ScanView scan{.T_WC = CameraAt(T_WB)};
    knowledge.Update({}, {&scan, 1}, Time{1s});
    return knowledge.memory().Looks(kTarget);
  };
  EXPECT_EQ(looks_after(0.55, 0.0), 1);
  EXPECT_EQ(looks_after(0.59, 4.0), 1) << "4 cm and 4 degrees from the first";
  EXPECT_EQ(looks_after(0.61, 0.0), 2) << "6 cm from the first, the last one that counted";
  EXPECT_EQ(looks_after(0.61, 6.0), 3);
  EXPECT_EQ(looks_after(0.61, 3.0), 3);
}

TEST(Knowledge, ThePlaceIsKnownOnceFreeSpaceIsWithinReach) {
  for (const int away : {2, 3, 4}) {
    const VoxelIndex free{away, 0, 0};
    const Knowledge knowledge =
        test::Knowing(test::BoxOf({free, free + VoxelIndex{1, 1, 1}}, VoxelState::kFree));
    // Reach is 0.3 m, to any point of a voxel.
    EXPECT_EQ(knowledge.KnowsPlace(test::At(0.05, 0.05, 0.05)), away <= 3) << away;
  }
}

TEST(Knowledge, ADrivingRobotKeepsTheHeightOfItsFirstPose) {
  Knowledge::Options options = test::KnowingOptions();
  EXPECT_EQ(Knowledge(options).InPlane(test::At(1, 2, 3)).translation(), Eigen::Vector3d(1, 2, 3));
  options.robot.drives = true;
  options.map.half_height = 0.2;
  Knowledge driving(options);
  EXPECT_EQ(driving.InPlane(test::At(1, 2, 0.25)).translation(), Eigen::Vector3d(1, 2, 0.25));
  EXPECT_EQ(driving.InPlane(test::At(4, 5, 0.31)).translation(), Eigen::Vector3d(4, 5, 0.25));
}

TEST(Knowledge, TheBodyOccupiesFreeSpace) {
  Knowledge knowledge(test::KnowingOptions());
  const Eigen::Vector3d p_W(0.05, 0.05, 0.05);
  knowledge.Occupy(p_W);
  EXPECT_EQ(knowledge.map().State({0, 0, 0}), VoxelState::kFree);
  EXPECT_EQ(knowledge.map().State({2, 0, 0}), VoxelState::kUnknown) << "0.15 m away, and its radius is 0.1 m";
  EXPECT_TRUE(knowledge.map().box().Contains({0, 0, 0}));
  EXPECT_EQ(knowledge.memory().set_aside().box(), knowledge.map().box()) << "the memory covers the new box";
}

TEST(Knowledge, RefusesOptionsThatMakeNoSense) {
  for (const auto& spoil : std::vector<void (*)(Knowledge::Options&)>{
           [](Knowledge::Options& options) { options.look_range = 0.0; },
           [](Knowledge::Options& options) { options.min_measured_share = 1.1; },
           [](Knowledge::Options& options) { options.memory.looks = 0; }}) {
    Knowledge::Options options = test::KnowingOptions();
    spoil(options);
    EXPECT_THROW(Knowledge{options}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace thalweg::explorer
