#include "services/evaluator/core/flown_trajectory.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "common/base/angles.h"
#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/text/run_end_text.h"
#include "services/simulator/core/depth_sensor.h"

namespace thalweg::evaluator {
namespace {

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

class FlownTrajectory : public testing::Test {
 protected:
  /// The start, turned about the vertical and moved.
  RigidTransform Pose(double turn_deg, const Eigen::Vector3d& moved_W = Eigen::Vector3d::Zero()) const {
    RigidTransform T_WB = scene_.Start(0);
    const Eigen::AngleAxisd turn(turn_deg * kDegree, Eigen::Vector3d::UnitZ());
    T_WB.linear() = turn.toRotationMatrix() * T_WB.linear();
    T_WB.translation() += moved_W;
    return T_WB;
  }
  LockstepResult Judge(const std::vector<TimedPose>& poses) {
    return Fly(scene_.world(), poses, options_, map_, *scene_.Truth(poses.front().T.translation()));
  }

  const Scene scene_{"tiny"};
  const LockstepOptions options_ = scene_.Options("closest", 1);
  mapper::OccupancyMap map_{options_.mapper};
};

TEST_F(FlownTrajectory, HasTheMapDistanceAndTimeOfItsScans) {
  const std::vector<TimedPose> poses = {{At(100.0), Pose(0.0)},
                                        {At(102.0), Pose(90.0, {0.1, 0.0, 0.0})},
                                        {At(103.0), Pose(180.0, {0.1, 0.05, 0.0})}};
  const LockstepResult result = Judge(poses);
  EXPECT_EQ(ToText(result.end), "end of the trajectory");
  EXPECT_DOUBLE_EQ(result.duration, 3.0);
  EXPECT_NEAR(result.distance, 0.15, 1e-9);
  EXPECT_EQ(result.collisions, 0);
  EXPECT_NEAR(static_cast<double>(result.scans), 3.0 * options_.sensor.rate + 1.0, 1.0);

  // The same scans by hand.
  mapper::OccupancyMap expected(options_.mapper);
  simulator::DepthSensor sensor(options_.sensor, options_.noise_seed, false);
  for (const LockstepResult::Sample& sample : result.samples) {
    const bool first = sample.time <= 2.0;
    const double share = first ? sample.time / 2.0 : sample.time - 2.0;
    const RigidTransform T_WB = Interpolate(poses[first ? 0 : 1].T, poses[first ? 1 : 2].T, share);
    EXPECT_TRUE(T_WB.translation().isApprox(sample.p_W, 1e-9));
    expected.Integrate(sensor.Capture(scene_.world(), T_WB * options_.robot.T_BC),
                       T_WB * options_.robot.T_BC);
  }
  std::size_t known = 0;
  std::size_t same = 0;
  expected.grid().ForEachKnown([&](const VoxelIndex& i, float) {
    ++known;
    same += map_.grid().State(i) == expected.grid().State(i) ? 1 : 0;
  });
  EXPECT_EQ(result.samples.back().known, known);
  EXPECT_GT(static_cast<double>(same), 0.999 * static_cast<double>(known));  // rounding of interpolated poses
  for (std::size_t k = 1; k < result.samples.size(); ++k) {
    EXPECT_GE(result.samples[k].observed, result.samples[k - 1].observed);
  }
  EXPECT_GT(result.samples.back().observed, result.samples.front().observed);
}

TEST_F(FlownTrajectory, ThroughAWallCollides) {
  const LockstepResult through = Judge({{At(0.0), Pose(0.0)}, {At(10.0), Pose(0.0, {20.0, 0.0, 0.0})}});
  EXPECT_GE(through.collisions, 1);
  EXPECT_NEAR(through.least_clearance, -options_.robot.radius, 0.02) << "its center crosses the surface";
}

TEST_F(FlownTrajectory, NeedsTwoPosesAndIncreasingStamps) {
  EXPECT_THROW(Judge({{At(0.0), Pose(0.0)}}), std::invalid_argument);
  EXPECT_THROW(Judge({{At(1.0), Pose(0.0)}, {At(1.0), Pose(1.0)}}), std::invalid_argument);
}

TEST_F(FlownTrajectory, IsAnOutcomeLikeOthers) {
  const std::vector<TimedPose> turn = {
      {At(0), Pose(0)}, {At(2), Pose(120)}, {At(4), Pose(240)}, {At(6), Pose(360)}};
  const Outcome outcome = scene_.JudgeTrajectory(turn, "turntable");
  EXPECT_EQ(outcome.strategy, "turntable");
  EXPECT_EQ(outcome.scenario, "tiny");
  EXPECT_FALSE(outcome.complete());
  EXPECT_GT(outcome.coverage, 0.3);
  EXPECT_LT(outcome.coverage, 1.0);
  EXPECT_NEAR(outcome.progress.back().coverage, outcome.coverage, 1e-9);
  EXPECT_THROW(scene_.JudgeTrajectory({}, "none"), std::invalid_argument);
  const std::vector<TimedPose> outside = {{At(0), Pose(0, {50, 0, 0})}, {At(1), Pose(0)}};
  EXPECT_THROW(scene_.JudgeTrajectory(outside, "outside"), std::invalid_argument);
}

TEST_F(FlownTrajectory, MeetsPartsThatMoveWhereTheyAreAtThatTimeAndLeavesTheWorldAsItIs) {
  // A post that is beside the flight until it shifts onto its line, between 1 and 2 s.
  const Eigen::Vector3d start_W = Pose(0.0).translation();
  const Eigen::Vector3d beside_W = start_W + Eigen::Vector3d(0.5, 0.4, 0.0);
  const simulator::MovingPart post{
      .at_rest_W = {beside_W - Eigen::Vector3d(0.05, 0.05, 0.1), beside_W + Eigen::Vector3d(0.05, 0.05, 0.1)},
      .places = {{.time = 1}, {.time = 2, .offset_W = Eigen::Vector3d(0, -0.4, 0)}}};
  const simulator::World world(scene_.world().mesh(), scene_.world().bounds(), {}, {post});
  const auto collisions_from = [&](double begin) {
    mapper::OccupancyMap map(options_.mapper);
    const std::vector<TimedPose> poses = {
        {At(0.0), Pose(0.0)}, {At(begin), Pose(0.0)}, {At(begin + 0.8), Pose(0.0, {0.8, 0.0, 0.0})}};
    return Fly(world, poses, options_, map, *scene_.Truth(start_W)).collisions;
  };
  EXPECT_EQ(collisions_from(0.1), 0) << "past it";
  EXPECT_EQ(collisions_from(3.0), 1) << "into it";
  EXPECT_EQ(collisions_from(0.1), 0) << "each flight begins with the timetable";
  EXPECT_EQ(world.parts().front().clock(), 0.0);
}

TEST(NothingMoves, IsDemandedByTheNameOfTheScenario) {
  EXPECT_NO_THROW(CheckNothingMoves({"tiny", "flat"}, {}, "--optimum"));
  try {
    CheckNothingMoves({"tiny", "flat_doors"}, {}, "--optimum");
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "--optimum needs a world that stays as it is, but parts of that of scenario flat_doors move "
              "(world.moving)");
  }
}

}  // namespace
}  // namespace thalweg::evaluator
