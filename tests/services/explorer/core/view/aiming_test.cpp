#include "services/explorer/core/view/aiming.h"

#include <gtest/gtest.h>

#include "common/geometry/polyline.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

using test::kLookRange;

/// Random scenes, each with a path through free space and some target voxels near its end.
class AimingTest : public testing::TestWithParam<unsigned> {
 protected:
  AimingTest() {
    std::mt19937 random(GetParam());
    map_.Apply(test::RandomScene(random, {{0, 0, 0}, {60, 30, 15}}, 30, 8));
    const std::vector<VoxelIndex> traversable = test::TraversableVoxels(map_);
    path_W_ = {map_.CenterOf(traversable[random() % traversable.size()])};
    while (path_W_.size() < 4) path_W_.push_back(map_.CenterOf(traversable[random() % traversable.size()]));
    for (const Sighting& sighting : SightingsFrom(map_, map_.EyeAt(path_W_.back()), kLookRange)) {
      if (random() % 4 == 0) target_.push_back(sighting.voxel);
    }
  }
  std::size_t SeenFrom(const Eigen::Vector3d& p_W, const std::vector<VoxelIndex>& voxels) const {
    return static_cast<std::size_t>(std::count_if(voxels.begin(), voxels.end(), [&](const VoxelIndex& i) {
      const Eigen::Vector3d offset_W = map_.CenterOf(i) - map_.EyeAt(p_W);
      return offset_W.norm() <= kLookRange && views_.CanShow(offset_W) &&
             map_.InSight(map_.EyeAt(p_W), map_.CenterOf(i));
    }));
  }

  PlanningMap map_{{.voxel_size = 0.1, .clearance = 0.15, .bounds = {}}};
  ViewPlanner views_{DepthSensorModel{}.camera, RobotModel{}};
  std::vector<Eigen::Vector3d> path_W_;
  std::vector<VoxelIndex> target_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, AimingTest, testing::Range(1U, 21U));

TEST_P(AimingTest, APathStopsAtTheFirstSampleThatSeesHalfOfWhatItsEndSees) {
  std::vector<VoxelIndex> seen_at_end;
  for (const VoxelIndex& i : target_) {
    if (SeenFrom(path_W_.back(), {i}) == 1) seen_at_end.push_back(i);
  }
  std::vector<Eigen::Vector3d> cut_W = path_W_;
  StopWhereSeen(map_, views_, kLookRange, target_, cut_W);
  if (seen_at_end.empty()) {
    EXPECT_EQ(cut_W, path_W_);
    return;
  }
  EXPECT_EQ(cut_W.front(), path_W_.front());
  EXPECT_GE(2 * SeenFrom(cut_W.back(), seen_at_end), seen_at_end.size());
  EXPECT_LE(PathLength(cut_W), PathLength(path_W_) + 1e-9);
  // No earlier sample sees as much.
  for (std::size_t n = 1; n < cut_W.size(); ++n) {
    const Eigen::Vector3d along = path_W_[n] - path_W_[n - 1];
    for (int piece = 0; piece <= 1000; ++piece) {
      const double distance = 0.001 * piece * along.norm();
      if (distance >= (cut_W[n] - cut_W[n - 1]).norm() - 1e-9) break;
      // Samples divide each segment into the fewest pieces of at most 0.2 m.
      const double step = along.norm() / PiecesOf(along.norm(), 0.2);
      const double sample = std::floor(distance / step) * step;
      const Eigen::Vector3d p_W = path_W_[n - 1] + sample * along.normalized();
      ASSERT_LT(2 * SeenFrom(p_W, seen_at_end), seen_at_end.size() + 1) << n << ", " << sample;
    }
  }
}

TEST_P(AimingTest, WithoutATargetAPathStaysAsItIs) {
  std::vector<Eigen::Vector3d> path_W = path_W_;
  StopWhereSeen(map_, views_, kLookRange, {}, path_W);
  EXPECT_EQ(path_W, path_W_);
}

TEST_P(AimingTest, TheBestViewShowsMostOfTheTargetAndThenMostOfWhatIsNotSetAside) {
  const std::vector<Sighting> sightings = SightingsFrom(map_, map_.EyeAt(path_W_.back()), kLookRange);
  DenseGrid<std::uint8_t> set_aside(map_.box(), 0);
  for (std::size_t n = 0; n < sightings.size(); n += 3) set_aside[sightings[n].voxel] = 1;
  const auto count = [&](const Eigen::Matrix3d& R_WB, auto&& counts) {
    return std::count_if(sightings.begin(), sightings.end(), [&](const Sighting& sighting) {
      return counts(sighting.voxel) && views_.Shows(R_WB, sighting);
    });
  };
  const auto in_target = [&](const VoxelIndex& i) {
    return std::find(target_.begin(), target_.end(), i) != target_.end();
  };
  const auto wanted = [&](const VoxelIndex& i) { return set_aside[i] == 0; };
  const View best = BestViewOf(target_, sightings, set_aside, views_, Eigen::Matrix3d::Identity());
  for (const Eigen::Matrix3d& R_WB : views_.candidates()) {
    EXPECT_LE(count(R_WB, in_target), count(best.R_WB, in_target));
    if (count(R_WB, in_target) == count(best.R_WB, in_target)) {
      EXPECT_LE(count(R_WB, wanted), count(best.R_WB, wanted));
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
