#include "services/visual_odometry/core/relative_adjustment.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/services/visual_odometry/support/rig.h"

namespace thalweg::visual_odometry {
namespace {

using test::kRig;

Vector6d RandomStep(std::mt19937_64& random, double meters, double radians) {
  std::normal_distribution<double> normal;
  Vector6d step;
  for (Eigen::Index k = 0; k < 6; ++k) step[k] = (k < 3 ? meters : radians) * normal(random);
  return step;
}

/// A window that observes points 1 to 6 m away, each hosted by one of its first keyframes.
AdjustmentWindow RandomWindow(std::uint64_t seed, int keyframes, int points, double noise_px) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  AdjustmentWindow window;
  for (int k = 1; k < keyframes; ++k) {
    window.steps.push_back(Moved(RandomStep(random, 0.06, 0.03), RigidTransform::Identity()));
  }
  while (static_cast<int>(window.points.size()) < points) {
    AdjustmentWindow::Point point;
    point.host = static_cast<int>(window.points.size()) % std::max(1, keyframes - 1);
    point.q = {0.4 * uniform(random), 0.3 * uniform(random), 1.0 / (3.5 + 2.5 * uniform(random))};
    for (int k = point.host; k < keyframes; ++k) {
      const StereoPixel exact = Project(kRig, ChainOf(window.steps, point.host, k), point.q);
      point.seen.push_back(
          {k, exact + noise_px * Eigen::Vector3d(normal(random), normal(random), normal(random)),
           k % 3 != 2});
    }
    window.points.push_back(std::move(point));
  }
  return window;
}

TEST(RelativeAdjustment, JacobiansEqualNumericOnes) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const AdjustmentWindow window = RandomWindow(static_cast<std::uint64_t>(trial), 5, 1, 0.0);
    InverseDepthPoint q = window.points[0].q;
    if (trial == 0) q[2] = 0.0;  // also at infinity
    const ChainJacobians exact = ProjectThroughChain(kRig, window.steps, q);
    ASSERT_TRUE(exact.in_front);
    constexpr double kStep = 1e-6;
    for (Eigen::Index k = 0; k < 3; ++k) {
      InverseDepthPoint more = q;
      InverseDepthPoint less = q;
      more[k] += kStep;
      less[k] -= kStep;
      const Eigen::Vector3d numeric = (ProjectThroughChain(kRig, window.steps, more).pixel -
                                       ProjectThroughChain(kRig, window.steps, less).pixel) /
                                      (2.0 * kStep);
      EXPECT_LT((numeric - exact.by_point.col(k)).norm(), 1e-6 * (1.0 + numeric.norm())) << "point " << k;
    }
    for (std::size_t step = 0; step < window.steps.size(); ++step) {
      for (Eigen::Index k = 0; k < 6; ++k) {
        Vector6d delta = Vector6d::Zero();
        delta[k] = kStep;
        std::vector<RigidTransform> more = window.steps;
        std::vector<RigidTransform> less = window.steps;
        more[step] = Moved(delta, more[step]);
        less[step] = Moved(-delta, less[step]);
        const Eigen::Vector3d numeric =
            (ProjectThroughChain(kRig, more, q).pixel - ProjectThroughChain(kRig, less, q).pixel) /
            (2.0 * kStep);
        EXPECT_LT((numeric - exact.by_step[step].col(k)).norm(), 1e-6 * (1.0 + numeric.norm()))
            << "step " << step << ", " << k;
      }
    }
  }
}

TEST(RelativeAdjustment, FindsTheTruthAgainWhenNothingIsNoisy) {
  const AdjustmentWindow truth = RandomWindow(5, 6, 60, 0.0);
  AdjustmentWindow window = truth;
  std::mt19937_64 random(6);
  for (RigidTransform& step : window.steps) step = Moved(RandomStep(random, 0.02, 0.01), step);
  for (auto& point : window.points) point.q[2] *= 1.1;
  const double error = Adjust(kRig, window, {.most_iterations = 30, .huber_px = 100.0});
  EXPECT_LT(error, 1e-6);
  for (std::size_t k = 0; k < truth.steps.size(); ++k) {
    EXPECT_TRUE(window.steps[k].isApprox(truth.steps[k], 1e-7)) << k;
  }
}

TEST(RelativeAdjustment, HoldsTheSettledSteps) {
  AdjustmentWindow window = RandomWindow(7, 5, 40, 0.5);
  window.held = {1, 1};
  const std::vector<RigidTransform> before = window.steps;
  Adjust(kRig, window, {.most_iterations = 10, .huber_px = 100.0});
  EXPECT_TRUE(window.steps[0].isApprox(before[0], 1e-12));
  EXPECT_TRUE(window.steps[1].isApprox(before[1], 1e-12));
  EXPECT_FALSE(window.steps[3].isApprox(before[3], 1e-6));
}

TEST(RelativeAdjustment, OneWrongSightingInTenDoesNotBendThePath) {
  const AdjustmentWindow truth = RandomWindow(8, 5, 60, 0.0);
  AdjustmentWindow window = truth;
  for (std::size_t i = 0; i < window.points.size(); i += 10) window.points[i].seen.back().pixel[0] += 15.0;
  Adjust(kRig, window, {.most_iterations = 50, .huber_px = 0.1});
  for (std::size_t k = 0; k < truth.steps.size(); ++k) {
    EXPECT_LT((window.steps[k].translation() - truth.steps[k].translation()).norm(), 2e-3) << k;
  }
}

/// The usual formulation for comparison: poses and points in one world frame, automatic derivatives.
struct AbsoluteCost {
  const AdjustmentWindow::Observation& seen;

  template <class T>
  bool operator()(const T* angle, const T* translation, const T* point, T* residual) const {
    T p[3];
    const T length2 = angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2];
    if (length2 > T(1e-20)) {
      const T length = sqrt(length2);
      const T axis[3] = {angle[0] / length, angle[1] / length, angle[2] / length};
      const T c = cos(length);
      const T s = sin(length);
      const T dot = axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2];
      const T cross[3] = {axis[1] * point[2] - axis[2] * point[1], axis[2] * point[0] - axis[0] * point[2],
                          axis[0] * point[1] - axis[1] * point[0]};
      for (int k = 0; k < 3; ++k) p[k] = point[k] * c + cross[k] * s + axis[k] * dot * (T(1) - c);
    } else {
      p[0] = point[0] + angle[1] * point[2] - angle[2] * point[1];
      p[1] = point[1] + angle[2] * point[0] - angle[0] * point[2];
      p[2] = point[2] + angle[0] * point[1] - angle[1] * point[0];
    }
    for (int k = 0; k < 3; ++k) p[k] += translation[k];
    const PinholeCamera& c = kRig.camera;
    residual[0] = c.fx * p[0] / p[2] + c.cx - seen.pixel[0];
    residual[1] = c.fy * p[1] / p[2] + c.cy - seen.pixel[1];
    if (seen.has_right) residual[2] = c.fx * (p[0] - kRig.baseline) / p[2] + c.cx - seen.pixel[2];
    return true;
  }
};

TEST(RelativeAdjustment, GivesTheSameAsAnAdjustmentInOneWorldFrame) {
  AdjustmentWindow window = RandomWindow(9, 5, 50, 0.4);
  const int keyframes = 5;
  std::vector<std::array<double, 3>> angles(keyframes);
  std::vector<std::array<double, 3>> translations(keyframes);
  std::vector<std::array<double, 3>> points;
  for (int k = 0; k < keyframes; ++k) {
    const RigidTransform T = ChainOf(window.steps, 0, k);
    const Eigen::AngleAxisd turn(T.linear());
    for (std::size_t i = 0; i < 3; ++i) {
      angles[static_cast<std::size_t>(k)][i] = turn.angle() * turn.axis()[static_cast<Eigen::Index>(i)];
      translations[static_cast<std::size_t>(k)][i] = T.translation()[static_cast<Eigen::Index>(i)];
    }
  }
  for (const auto& point : window.points) {
    const Eigen::Vector3d p_host = Eigen::Vector3d(point.q[0], point.q[1], 1.0) / point.q[2];
    const Eigen::Vector3d p = ChainOf(window.steps, 0, point.host).inverse() * p_host;
    points.push_back({p.x(), p.y(), p.z()});
  }
  ceres::Problem problem;
  for (std::size_t i = 0; i < window.points.size(); ++i) {
    for (const auto& seen : window.points[i].seen) {
      const auto k = static_cast<std::size_t>(seen.keyframe);
      ceres::CostFunction* cost = nullptr;
      if (seen.has_right) {
        cost = new ceres::AutoDiffCostFunction<AbsoluteCost, 3, 3, 3, 3>(new AbsoluteCost{seen});
      } else {
        cost = new ceres::AutoDiffCostFunction<AbsoluteCost, 2, 3, 3, 3>(new AbsoluteCost{seen});
      }
      problem.AddResidualBlock(cost, nullptr, angles[k].data(), translations[k].data(), points[i].data());
    }
  }
  problem.SetParameterBlockConstant(angles[0].data());
  problem.SetParameterBlockConstant(translations[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  for (int round = 0; round < 10; ++round) Adjust(kRig, window, {.most_iterations = 100, .huber_px = 1e6});
  for (int k = 1; k < keyframes; ++k) {
    const RigidTransform relative = ChainOf(window.steps, 0, k);
    const auto& a = angles[static_cast<std::size_t>(k)];
    const auto& t = translations[static_cast<std::size_t>(k)];
    EXPECT_LT((relative.translation() - Eigen::Vector3d(t[0], t[1], t[2])).norm(), 1e-5) << k;
    EXPECT_LT((relative.linear() - RotationFromVector({a[0], a[1], a[2]})).norm(), 1e-5) << k;
  }
}

/// The window as cameras see it whose right image is bent, with points that are adjusted to that.
AdjustmentWindow Bent(AdjustmentWindow window, const DisparityBias& bias) {
  for (AdjustmentWindow::Point& point : window.points) {
    for (AdjustmentWindow::Observation& seen : point.seen) {
      seen.pixel[2] += bias.dot(BiasBasis(kRig.camera, seen.pixel[2]));
    }
  }
  Adjust(kRig, window, {.most_iterations = 20});
  return window;
}

TEST(EvidenceOfBias, DistinguishesABentRightImageFromMotion) {
  const DisparityBias truth(0.8, 1.5);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto evidence = EvidenceOfBias(kRig, Bent(RandomWindow(seed, 8, 200, 0.1), truth), 0.05);
    ASSERT_TRUE(evidence);
    const Eigen::Vector2d error = evidence->residual - truth;
    // 1 in 1000 lies beyond 13.8; the step is one of Gauss-Newton, and the loss is robust.
    EXPECT_LT(error.dot(evidence->information * error), 2.0 * 13.8) << error.transpose();
    EXPECT_GT(evidence->information(0, 0), 1.0 / (0.3 * 0.3));
    EXPECT_GE(evidence->with_known_motion, evidence->information(0, 0));
  }
}

TEST(EvidenceOfBias, FindsNoneWithoutOne) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto evidence =
        EvidenceOfBias(kRig, Bent(RandomWindow(seed, 8, 200, 0.1), DisparityBias::Zero()), 0.05);
    ASSERT_TRUE(evidence);
    EXPECT_LT(evidence->residual.dot(evidence->information * evidence->residual), 2.0 * 13.8);
  }
}

TEST(EvidenceOfBias, SaysNothingFromAFewPoints) {
  EXPECT_FALSE(EvidenceOfBias(kRig, RandomWindow(1, 5, 10, 0.1), 0.05));
}

}  // namespace
}  // namespace thalweg::visual_odometry
