#include "services/explorer/core/view/view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/angles.h"
#include "common/geometry/spread_directions.h"
#include "services/explorer/core/map/frontier.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

class ViewTest : public testing::TestWithParam<unsigned> {
 protected:
  ViewTest() { map_.Apply(test::RandomScene(random_, {{0, 0, 0}, {16, 15, 14}}, 14, 5)); }
  Eigen::Vector3d FreePoint() {
    for (;;) {
      const Eigen::Vector3d p_W =
          test::RandomPoint(random_, {Eigen::Vector3d::Zero(), Eigen::Vector3d(1.6, 1.5, 1.4)});
      if (map_.State(map_.IndexOf(p_W)) == VoxelState::kFree) return p_W;
    }
  }

  RobotModel Robot(Attitude attitude) const {
    RobotModel robot{.attitude = attitude};
    robot.T_BC.linear() = R_BC_;
    return robot;
  }

  std::mt19937 random_{GetParam()};
  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  PinholeCamera camera_ = PinholeCamera::FromFieldOfView(100, 60, 75 * kDegree);
  Eigen::Matrix3d R_BC_ = RotationFromYawPitch(0.0, -20 * kDegree) * BodyFromOptical();
};
INSTANTIATE_TEST_SUITE_P(Seeds, ViewTest, testing::Range(1U, 7U));

TEST_P(ViewTest, SightingsAreTheTargetsInRangeAndInPlainSight) {
  for (int n = 0; n < 5; ++n) {
    const Eigen::Vector3d p_W = FreePoint();
    const double range = test::RandomDouble(random_, 0.4, 1.8);
    std::vector<VoxelIndex> expected;
    test::ForEachVoxel(map_.box(), [&](const VoxelIndex& i) {
      const Eigen::Vector3d center = map_.CenterOf(i);
      if (IsTarget(map_, i) && (center - p_W).norm() <= range && map_.InSight(p_W, center)) {
        expected.push_back(i);
      }
    });
    const std::vector<Sighting> sightings = SightingsFrom(map_, p_W, range);
    ASSERT_EQ(sightings.size(), expected.size());
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      EXPECT_EQ(sightings[k].voxel, expected[k]);
      EXPECT_LT((p_W + sightings[k].offset_W - map_.CenterOf(expected[k])).norm(), 1e-12);
    }
  }
}

TEST_P(ViewTest, WhatTheSparseViewsShowIsWhatTheCameraSees) {
  for (const double fov : {30.0, 75.0, 120.0}) {
    for (const Attitude attitude : {Attitude::kFree, Attitude::kLevel, Attitude::kGimbal}) {
      const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 60, fov * kDegree);
      const ViewPlanner planner(camera, Robot(attitude));
      std::vector<Eigen::Vector3d> offsets_W;
      for (int n = 0; n < 300; ++n)
        offsets_W.push_back(
            test::RandomPoint(random_, {Eigen::Vector3d(-2, -2, -2), Eigen::Vector3d(2, 2, 2)}));
      // The corners of the images, where the cone around them ends.
      for (const Eigen::Matrix3d& R_WB : planner.sparse()) {
        for (const double u : {-0.5 + 1e-6, 99.5 - 1e-6}) {
          for (const double v : {-0.5 + 1e-6, 59.5 - 1e-6})
            offsets_W.emplace_back(R_WB * R_BC_ * camera.RayAtUnitDepth(u, v));
        }
      }
      const BitTable shown = planner.ShownBySparse(offsets_W);
      ASSERT_EQ(shown.rows(), planner.sparse().size());
      for (std::size_t n = 0; n < offsets_W.size(); ++n) {
        bool any = false;
        for (std::size_t k = 0; k < shown.rows(); ++k) {
          const bool sees = camera.Sees((planner.sparse()[k] * R_BC_).transpose() * offsets_W[n]);
          EXPECT_EQ(shown.Get(k, n), sees);
          any = any || sees;
        }
        EXPECT_TRUE(planner.CanShow(offsets_W[n]) || !any);
      }
    }
  }
}

TEST_P(ViewTest, TheBestViewShowsAsManyRequiredSightingsAsAnyAndOfThoseTheMost) {
  const ViewPlanner planner(camera_, Robot(Attitude::kFree));
  for (int n = 0; n < 6; ++n) {
    const std::vector<Sighting> sightings = SightingsFrom(map_, FreePoint(), 2.0);
    std::vector<bool> counts;
    std::vector<bool> required;
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      counts.push_back(random_() % 2 == 0);
      required.push_back(random_() % 4 == 0);
    }
    if (n % 2 == 0) required.clear();
    const Eigen::Matrix3d R_WB = RotationFromYawPitch(test::RandomDouble(random_, -3, 3), 0.1);
    const auto tally = [&](const Eigen::Matrix3d& R) {
      View view{R};
      for (std::size_t k = 0; k < sightings.size(); ++k) {
        if (!camera_.Sees((R * R_BC_).transpose() * sightings[k].offset_W)) continue;
        view.count += counts[k] ? 1U : 0U;
        view.required += !required.empty() && required[k] ? 1U : 0U;
      }
      return view;
    };
    const View best = planner.Best(sightings, counts, required, R_WB);
    EXPECT_EQ(tally(best.R_WB).count, best.count);
    EXPECT_EQ(tally(best.R_WB).required, best.required);
    const double turn = Eigen::AngleAxisd(R_WB.transpose() * best.R_WB).angle();
    for (int heading = 0; heading < 16; ++heading) {
      for (int elevation = -75; elevation <= 75; elevation += 25) {
        const View other = tally(RotationFromYawPitch(heading * 22.5 * kDegree, elevation * kDegree));
        EXPECT_LE(other.required, best.required);
        if (other.required != best.required) continue;
        EXPECT_LE(other.count, best.count);
        if (other.count != best.count) continue;
        EXPECT_GE(Eigen::AngleAxisd(R_WB.transpose() * other.R_WB).angle(), turn - 1e-9);
      }
    }
  }
}

TEST_P(ViewTest, WithNothingToSeeTheRobotHardlyTurns) {
  const ViewPlanner planner(camera_, Robot(Attitude::kFree));
  const Eigen::Matrix3d R_WB = RotationFromYawPitch(test::RandomDouble(random_, -3, 3), 0.0);
  const View best = planner.Best({}, {}, {}, R_WB);
  EXPECT_EQ(best.count, 0U);
  EXPECT_LE(Eigen::AngleAxisd(R_WB.transpose() * best.R_WB).angle(), 11.25 * kDegree + 1e-9);
}

TEST(ViewPlanner, FewerViewsLeaveOutNoDirection) {
  const RobotModel robot;
  const PinholeCamera wide = PinholeCamera::FromFieldOfView(100, 100, 75.0 * kDegree);
  const PinholeCamera least = PinholeCamera::FromFieldOfView(1000, 1020, 49.3 * kDegree);  // 50.2 deg high
  const PinholeCamera narrow = PinholeCamera::FromFieldOfView(100, 100, 40.0 * kDegree);
  EXPECT_EQ(ViewPlanner(wide, robot).sparse().size(), 8U * 4U);
  EXPECT_EQ(ViewPlanner(narrow, robot).sparse().size(), 16U * 7U);
  EXPECT_EQ(ViewPlanner(wide, {.attitude = Attitude::kLevel}).sparse().size(), 16U);
  EXPECT_EQ(ViewPlanner(least, robot).sparse().size(), 8U * 4U);
  for (const PinholeCamera& camera : {wide, least, narrow}) {
    const ViewPlanner views(camera, robot);
    for (const Eigen::Vector3d& direction : SpreadDirections(5000)) {
      EXPECT_TRUE(std::ranges::any_of(views.sparse(), [&](const Eigen::Matrix3d& R_WB) {
        return views.Shows(R_WB, {{0, 0, 0}, direction});
      })) << direction.transpose();
    }
  }
}

TEST(ViewPlanner, AGimbalShowsAllThatItsLimitsAllow) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 60, 75.0 * kDegree);
  const double to_top = std::atan(0.5 * camera.height_px / camera.fy);
  RobotModel robot{.attitude = Attitude::kGimbal};
  for (const auto& [lowest, highest] : {std::pair(-90.0, 30.0), {-20.0, 20.0}, {15.0, 15.0}}) {
    robot.gimbal_lowest = lowest * kDegree;
    robot.gimbal_highest = highest * kDegree;
    const ViewPlanner views(camera, robot);
    for (const Eigen::Matrix3d& R_WB : views.candidates()) {
      EXPECT_NEAR(R_WB(2, 1), 0.0, 1e-12) << "no roll";
      const double pitch = std::asin(std::clamp(R_WB(2, 0), -1.0, 1.0));
      EXPECT_GE(pitch, robot.gimbal_lowest - 1e-6);
      EXPECT_LE(pitch, robot.gimbal_highest + 1e-6);
    }
    for (const Eigen::Vector3d& direction : SpreadDirections(5000)) {
      const double elevation = std::asin(direction.z());
      const bool inside =
          elevation > robot.gimbal_lowest - 0.8 * to_top && elevation < robot.gimbal_highest + 0.8 * to_top;
      const bool outside =
          elevation < robot.gimbal_lowest - to_top - 0.01 || elevation > robot.gimbal_highest + to_top + 0.01;
      if (inside || outside) {
        EXPECT_EQ(views.CanShow(direction), inside) << direction.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
