#include "services/evaluator/core/stereo_sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/core/flown_trajectory.h"
#include "services/evaluator/core/run_sensor.h"

namespace thalweg::evaluator {
namespace {

/// The scenario tiny_stereo, whose clouds come from matched images.
class StereoSensorTest : public testing::Test {
 protected:
  RigidTransform StartOfCamera() const { return scene_.Start(0) * options_.robot.T_BC; }

  const Scene scene_{"tiny_stereo"};
  const LockstepOptions options_ = scene_.Options("closest", 1);
};

TEST_F(StereoSensorTest, IsThatOfAScenarioWhoseDepthIsFromStereoAndOfNoOther) {
  EXPECT_FALSE(Scene("tiny").Options("closest", 1).stereo);
  ASSERT_TRUE(options_.stereo);
  EXPECT_EQ(options_.stereo->rig.camera.width_px, 320);
  EXPECT_EQ(options_.stereo->matcher.max_disparity, 96);
  EXPECT_FALSE(options_.stereo->matcher.best.fill_surfaces) << "as in the service, nothing is guessed";
  EXPECT_EQ(options_.stereo->rate, 2.0);
  EXPECT_EQ(Scene("tiny_stereo", {"stereo.rate_hz=0.5"}).Options("closest", 1).stereo->rate, 0.5);
}

TEST_F(StereoSensorTest, SeesSurfacesWhereTheyAreAndTheSameEachTime) {
  const RigidTransform T_WC = StartOfCamera();
  const PointCloud cloud = StereoSensor(*options_.stereo, 1).Capture(scene_.world(), T_WC);
  ASSERT_EQ(cloud.width_px, 320);
  ASSERT_EQ(cloud.height_px, 240);
  std::size_t measured = 0;
  std::size_t right = 0;
  for (const Eigen::Vector3f& p_C : cloud.points_C) {
    if (!std::isfinite(p_C.z())) continue;
    ++measured;
    const Eigen::Vector3d p_W = T_WC * p_C.cast<double>();
    if (scene_.world().DistanceToSurface(p_W, 1.0) < 0.03) ++right;
  }
  EXPECT_GT(static_cast<double>(measured), 0.7 * 320 * 240);
  EXPECT_GT(static_cast<double>(right), 0.97 * static_cast<double>(measured));
  EXPECT_LT(right, measured) << "matched, not read from the world";

  const PointCloud again = StereoSensor(*options_.stereo, 1).Capture(scene_.world(), T_WC);
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    const bool both_missing = std::isnan(cloud.points_C[k].z()) && std::isnan(again.points_C[k].z());
    ASSERT_TRUE(both_missing || cloud.points_C[k] == again.points_C[k]);
  }
}

TEST_F(StereoSensorTest, GivesTheCloudsOfARunAtItsOwnRate) {
  RunSensor sensor(options_.sensor, options_.stereo, 1, /*colors=*/true);
  EXPECT_EQ(sensor.rate(), 2.0);
  const PointCloud colored = sensor.Capture(scene_.world(), StartOfCamera());
  EXPECT_EQ(colored.colors.size(), colored.points_C.size());
  RunSensor other(options_.sensor, {}, 1, /*colors=*/false);
  EXPECT_EQ(other.rate(), options_.sensor.rate);
  EXPECT_EQ(other.Capture(scene_.world(), StartOfCamera()).width_px, options_.sensor.camera.width_px);

  // A robot that stands still for three seconds.
  const RigidTransform start = scene_.Start(0);
  const std::vector<TimedPose> poses = {{Time{FromSeconds(1.0)}, start}, {Time{FromSeconds(4.0)}, start}};
  mapper::OccupancyMap map(options_.mapper);
  const LockstepResult result = Fly(scene_.world(), poses, options_, map, *scene_.Truth(start.translation()));
  EXPECT_NEAR(static_cast<double>(result.scans), 3.0 * 2.0 + 1.0, 1.0);
  EXPECT_GT(map.grid().block_count(), 3U);
}

}  // namespace
}  // namespace thalweg::evaluator
