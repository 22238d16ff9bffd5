#include "services/visual_odometry/core/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thalweg::visual_odometry {
namespace {

RigidTransform Turned(double yaw, const Eigen::Vector3d& p) {
  return MakeTransform(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix(), p);
}

TEST(TrajectoryError, IsNothingForTheSameTrajectoryInAnotherFrame) {
  std::vector<PosePair> poses;
  const RigidTransform T = Turned(1.0, {3, -2, 1});
  for (int i = 0; i <= 400; ++i) {
    const RigidTransform truth = Turned(0.01 * i, {0.5 * i, std::sin(0.05 * i), 0.0});
    poses.push_back({Time{}, T * truth, truth});
  }
  const TrajectoryError error = Compare(poses);
  EXPECT_NEAR(error.ate_rmse, 0.0, 1e-9);
  EXPECT_NEAR(error.drift_max, 0.0, 1e-9);
  EXPECT_NEAR(error.relative_translation, 0.0, 1e-9);
  EXPECT_NEAR(error.relative_rotation, 0.0, 1e-9);
  EXPECT_EQ(error.by_length.size(), 2U);  // 100 and 200 m of 200.1
}

TEST(TrajectoryError, APathTwoPercentTooLongIsTwoPercentWrongAtEachLength) {
  std::vector<PosePair> poses;
  for (int i = 0; i <= 600; ++i) {
    poses.push_back({Time{}, Turned(0.0, {1.02 * 0.1 * i, 0, 0}), Turned(0.0, {0.1 * i, 0, 0})});
  }
  const TrajectoryError error = Compare(poses);
  EXPECT_NEAR(error.path_length, 60.0, 1e-9);
  ASSERT_EQ(error.by_length.size(), 6U);
  for (const RelativeError& relative : error.by_length) EXPECT_NEAR(relative.translation, 0.02, 5e-4);
  EXPECT_NEAR(error.drift, 1.2, 1e-9);
  EXPECT_NEAR(error.relative_rotation, 0.0, 1e-12);
}

TEST(TrajectoryError, ASteadyTurnTooMuchIsThatTurnAMeter) {
  std::vector<PosePair> poses;
  for (int i = 0; i <= 1000; ++i) {
    const Eigen::Vector3d p(0.5 * i, 0, 0);
    poses.push_back({Time{}, Turned(0.001 * 0.5 * i, p), Turned(0.0, p)});
  }
  const TrajectoryError error = Compare(poses);
  EXPECT_NEAR(error.relative_rotation, 0.001, 1e-6);
  EXPECT_NEAR(error.drift_angle, 0.5, 1e-9);
}

TEST(TrajectoryError, HasNoRelativePartForAStandingCamera) {
  const std::vector<PosePair> poses(20, {Time{}, RigidTransform::Identity(), Turned(0.3, {1, 2, 3})});
  const TrajectoryError error = Compare(poses);
  EXPECT_TRUE(error.by_length.empty());
  EXPECT_TRUE(std::isnan(error.relative_translation));
  EXPECT_NEAR(error.drift, 0.0, 1e-12);
}

TEST(TrajectoryError, CountsTheErrorsWithinThe95PercentEllipsoid) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Matrix6d root = Matrix6d::Zero();
  for (double& value : root.reshaped()) value = 0.01 * normal(random);
  root += 0.02 * Matrix6d::Identity();
  const RigidTransform T_OW = Turned(0.7, {1, 2, 3});
  std::vector<PosePair> poses{{Time{}, T_OW, RigidTransform::Identity()}};
  for (int i = 1; i <= 5000; ++i) {
    const RigidTransform truth = Turned(0.01 * i, {0.1 * i, 0, 0});
    Vector6d x;
    for (double& value : x) value = normal(random);
    const RigidTransform off = Moved(root * x, RigidTransform::Identity());
    poses.push_back({Time{}, T_OW * truth * off.inverse(), truth, root * root.transpose()});
  }
  TrajectoryError error = Compare(poses);
  EXPECT_NEAR(error.inside_position, 0.95, 0.01);
  EXPECT_NEAR(error.inside_rotation, 0.95, 0.01);
  for (PosePair& pose : poses) pose.covariance *= 0.25;  // 7.815 / 4 of three degrees of freedom
  error = Compare(poses);
  EXPECT_NEAR(error.inside_position, 0.418, 0.02);
  for (PosePair& pose : poses) pose.covariance.setZero();
  EXPECT_TRUE(std::isnan(Compare(poses).inside_rotation)) << "of none";
}

TEST(TrajectoryError, NeedsTwoPoses) {
  EXPECT_THROW(Compare({}), std::invalid_argument);
  EXPECT_THROW(Compare(std::vector<PosePair>(1)), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::visual_odometry
