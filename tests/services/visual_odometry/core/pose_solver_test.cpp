#include "services/visual_odometry/core/pose_solver.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "tests/services/visual_odometry/support/rig.h"

namespace thalweg::visual_odometry {
namespace {

using test::kRig;

RigidTransform SomeMotion() {
  return MakeTransform(RotationFromVector({0.05, -0.12, 0.08}), Eigen::Vector3d(0.10, -0.06, 0.15));
}

/// Points as a stereo pair in K measures them and camera C sees them, both with the given noise.
std::vector<PosePoint> RandomPoints(std::mt19937_64& random, int count, const RigidTransform& T_CK,
                                    double noise_px) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise_px > 0.0 ? noise_px : 1e-12);
  const Eigen::Matrix3d J = TriangulationJacobian(kRig);
  std::vector<PosePoint> points;
  for (int i = 0; i < count; ++i) {
    const InverseDepthPoint q_true(0.5 * uniform(random), 0.35 * uniform(random),
                                   1.0 / (4.0 + 3.0 * uniform(random)));
    const auto noise = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
    PosePoint point;
    point.q_K = q_true + J * noise();
    point.q_covariance = J * J.transpose();
    point.pixel = Project(kRig, T_CK, q_true) + noise();
    point.has_right = i % 4 != 0;
    points.push_back(point);
  }
  return points;
}

TEST(PoseSolver, FindsAKnownMotionExactly) {
  std::mt19937_64 random(1);
  const RigidTransform truth = SomeMotion();
  const auto points = RandomPoints(random, 40, truth, 0.0);
  const auto solution = SolvePose(kRig, points, RigidTransform::Identity(), 0.3, {});
  ASSERT_TRUE(solution);
  EXPECT_TRUE(solution->T_CK.isApprox(truth, 1e-8));
  EXPECT_EQ(solution->inliers, 40);
}

TEST(PoseSolver, TwoPointsInFiveMayLie) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> anywhere(20.0, 360.0);
  const RigidTransform truth = SomeMotion();
  auto points = RandomPoints(random, 100, truth, 0.2);
  for (std::size_t i = 0; i < 40; ++i)
    points[i].pixel = {anywhere(random), anywhere(random), anywhere(random)};
  const auto consensus = FindConsensus(kRig, points, RigidTransform::Identity(), {}, 3);
  ASSERT_TRUE(consensus);
  EXPECT_GE(consensus->inliers, 55);
  const auto solution = SolvePose(kRig, points, consensus->T_CK, 0.3, {});
  ASSERT_TRUE(solution);
  EXPECT_LT((solution->T_CK.translation() - truth.translation()).norm(), 0.01);
  EXPECT_LT(AngleBetween(solution->T_CK, truth), 0.003);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(solution->inlier[i], 0) << i;
}

TEST(PoseSolver, SaysThatThreePointsAreTooFew) {
  std::mt19937_64 random(3);
  const auto points = RandomPoints(random, 3, SomeMotion(), 0.0);
  EXPECT_FALSE(FindConsensus(kRig, points, RigidTransform::Identity(), {}, 1));
  EXPECT_FALSE(SolvePose(kRig, points, RigidTransform::Identity(), 0.3, {}));
}

TEST(PoseSolver, ErrorsLieWithinThe95PercentEllipseIn95PercentOfTheTrials) {
  std::mt19937_64 random(4);
  constexpr int kTrials = 1000;
  int inside = 0;
  double sigma = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const RigidTransform truth = SomeMotion();
    const auto points = RandomPoints(random, 80, truth, 0.4);
    const auto solution = SolvePose(kRig, points, truth, 0.4, {});
    ASSERT_TRUE(solution);
    const RigidTransform error = truth * solution->T_CK.inverse();
    const Eigen::AngleAxisd turn(error.linear());
    Vector6d x;
    x << error.translation(), turn.angle() * turn.axis();
    inside += x.dot(solution->covariance.inverse() * x) < 12.592;  // chi^2, 6 degrees of freedom, 95 %
    sigma += solution->sigma_px / kTrials;
  }
  EXPECT_NEAR(sigma, 0.4, 0.03);
  EXPECT_GT(inside, 0.90 * kTrials);
  EXPECT_LT(inside, 0.99 * kTrials);
}

}  // namespace
}  // namespace thalweg::visual_odometry
