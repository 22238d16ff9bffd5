#include "services/visual_odometry/core/relative_adjustment.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "common/base/check.h"
#include "common/base/median.h"
#include "services/visual_odometry/core/robust_sigma.h"

namespace thalweg::visual_odometry {
namespace {

constexpr double kLeastSigma = 0.05;    // [px] of pixels
constexpr double kResidualHuber = 2.5;  // [sigmas] of residuals in three dimensions
constexpr double kOutlier = 6.0;        // [sigmas]
constexpr double kDamping = 1e-6;

/// A pose as a Ceres parameter block: quaternion (x, y, z, w), translation.
using PoseBlock = std::array<double, 7>;

PoseBlock ToBlock(const RigidTransform& T) {
  const Eigen::Quaterniond q(T.linear());
  return {q.x(), q.y(), q.z(), q.w(), T.translation().x(), T.translation().y(), T.translation().z()};
}

RigidTransform FromBlock(const double* block) {
  const Eigen::Quaterniond q(block[3], block[0], block[1], block[2]);
  return MakeTransform(q.normalized().toRotationMatrix(), {block[4], block[5], block[6]});
}

/// Moved() as a Ceres manifold. The cost functions write derivatives by the six tangent coordinates into the
/// first six of seven columns, so that the Jacobian of Plus is just that selection.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const PoseBlock moved = ToBlock(Moved(Eigen::Map<const Vector6d>(delta), FromBlock(x)));
    std::copy(moved.begin(), moved.end(), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
    J.setZero();
    J.topRows<6>().setIdentity();
    return true;
  }
  // Minimization needs only Plus.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};

/// Reprojection error of a point in a keyframe. Parameters: the point, then the steps from its host.
class ReprojectionCost final : public ceres::CostFunction {
 public:
  ReprojectionCost(const StereoGeometry& rig, const AdjustmentWindow::Observation& seen, int steps)
      : rig_(rig), seen_(seen) {
    set_num_residuals(seen.has_right ? 3 : 2);
    mutable_parameter_block_sizes()->push_back(3);
    for (int k = 0; k < steps; ++k) mutable_parameter_block_sizes()->push_back(7);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const auto steps = parameter_block_sizes().size() - 1;
    std::vector<RigidTransform> chain(steps);
    for (std::size_t k = 0; k < steps; ++k) chain[k] = FromBlock(parameters[k + 1]);
    const auto projection =
        ProjectThroughChain(rig_, chain, Eigen::Map<const Eigen::Vector3d>(parameters[0]));
    if (!projection.in_front) return false;
    const int rows = num_residuals();
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = (projection.pixel - seen_.pixel).head(rows);
    if (jacobians == nullptr) return true;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Rows>(jacobians[0], rows, 3) = projection.by_point.topRows(rows);
    }
    for (std::size_t k = 0; k < steps; ++k) {
      if (jacobians[k + 1] == nullptr) continue;
      Eigen::Map<Rows> J(jacobians[k + 1], rows, 7);
      J.leftCols(6) = projection.by_step[k].topRows(rows);
      J.col(6).setZero();
    }
    return true;
  }

 private:
  const StereoGeometry& rig_;
  const AdjustmentWindow::Observation& seen_;
};

}  // namespace

RigidTransform ChainOf(const std::vector<RigidTransform>& steps, int from, int to) {
  RigidTransform T = RigidTransform::Identity();
  for (int k = from; k < to; ++k) T = steps[static_cast<std::size_t>(k)] * T;
  return T;
}

ChainJacobians ProjectThroughChain(const StereoGeometry& rig, const std::vector<RigidTransform>& chain,
                                   const InverseDepthPoint& q) {
  ChainJacobians result;
  // m_k: the scaled point in the frame that step k leads to.
  std::vector<Eigen::Vector3d> m(chain.size());
  Eigen::Vector3d last(q[0], q[1], 1.0);
  RigidTransform T = RigidTransform::Identity();
  for (std::size_t k = 0; k < chain.size(); ++k) {
    last = chain[k].linear() * last + q[2] * chain[k].translation();
    m[k] = last;
    T = chain[k] * T;
  }
  result.in_front = last.z() > 1e-3;
  if (!result.in_front) return result;
  result.pixel = ProjectScaled(rig, last, q[2]);
  result.by_point = PointJacobian(rig, T, q);
  result.by_step.resize(chain.size());
  const Eigen::Matrix3d by_m = ProjectionJacobian(rig, last, q[2]);
  // Rotation from the frame that step k leads to, to the last one
  Eigen::Matrix3d R_rest = Eigen::Matrix3d::Identity();
  for (std::size_t k = chain.size(); k-- > 0;) {
    Eigen::Matrix<double, 3, 6> dm;
    dm << q[2] * Eigen::Matrix3d::Identity(), -Cross(m[k]);
    result.by_step[k] = by_m * R_rest * dm;
    R_rest = R_rest * chain[k].linear();
  }
  return result;
}

double Adjust(const StereoGeometry& rig, AdjustmentWindow& window, const AdjustmentOptions& options) {
  std::vector<PoseBlock> blocks;
  blocks.reserve(window.steps.size());
  for (const RigidTransform& T : window.steps) blocks.push_back(ToBlock(T));

  PoseManifold manifold;
  ceres::HuberLoss loss(options.huber_px);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  auto* const ordering = new ceres::ParameterBlockOrdering;  // owned by the solver's options
  for (PoseBlock& block : blocks) {
    problem.AddParameterBlock(block.data(), 7, &manifold);
    ordering->AddElementToGroup(block.data(), 1);
  }
  for (std::size_t k = 0; k < std::min(window.held.size(), blocks.size()); ++k) {
    if (window.held[k] != 0) problem.SetParameterBlockConstant(blocks[k].data());
  }
  std::size_t observations = 0;
  for (AdjustmentWindow::Point& point : window.points) {
    problem.AddParameterBlock(point.q.data(), 3);
    ordering->AddElementToGroup(point.q.data(), 0);
    for (const AdjustmentWindow::Observation& seen : point.seen) {
      THALWEG_CHECK(seen.keyframe >= point.host && seen.keyframe <= static_cast<int>(blocks.size()));
      std::vector<double*> parameters{point.q.data()};
      for (int k = point.host; k < seen.keyframe; ++k) {
        parameters.push_back(blocks[static_cast<std::size_t>(k)].data());
      }
      problem.AddResidualBlock(new ReprojectionCost(rig, seen, seen.keyframe - point.host), &loss,
                               parameters);
      ++observations;
    }
  }
  if (observations == 0) return 0.0;
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering.reset(ordering);
  solver.max_num_iterations = options.most_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.function_tolerance = 1e-5;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  for (std::size_t k = 0; k < blocks.size(); ++k) window.steps[k] = FromBlock(blocks[k].data());
  return std::sqrt(2.0 * summary.final_cost / static_cast<double>(observations));
}

std::optional<BiasEvidence> EvidenceOfBias(const StereoGeometry& rig, const AdjustmentWindow& window,
                                           double point_sigma_px) {
  struct Seen {
    std::size_t point;
    int host;
    int steps;
    int rows;
    ChainJacobians by;
    Eigen::Vector3d residual;
    Eigen::Vector2d basis;
  };
  std::vector<Seen> all;
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < window.points.size(); ++i) {
    const AdjustmentWindow::Point& point = window.points[i];
    if (point.seen.size() < 2) continue;
    for (const AdjustmentWindow::Observation& seen : point.seen) {
      const auto first = window.steps.begin() + point.host;
      const std::vector<RigidTransform> chain(first, window.steps.begin() + seen.keyframe);
      Seen one{i,
               point.host,
               seen.keyframe - point.host,
               seen.has_right ? 3 : 2,
               ProjectThroughChain(rig, chain, point.q),
               {},
               {}};
      if (!one.by.in_front) continue;
      one.residual = one.by.pixel - seen.pixel;
      if (!seen.has_right) one.residual[2] = 0.0;
      one.basis = BiasBasis(rig.camera, seen.pixel[2]);
      sigmas.push_back(SigmaByLength(one.residual.norm(), one.rows));
      all.push_back(std::move(one));
    }
  }
  // A point takes up as many dimensions of its residuals as it has unknowns.
  std::set<std::size_t> points;
  for (const Seen& seen : all) points.insert(seen.point);
  constexpr std::size_t kLeastPoints = 20;
  if (points.size() < kLeastPoints) return std::nullopt;
  const double rows = 3.0 * static_cast<double>(all.size());
  const double free =
      rows - 3.0 * static_cast<double>(points.size()) - 6.0 * static_cast<double>(window.steps.size());
  if (free < 0.1 * rows) return std::nullopt;
  const double sigma = std::max(kLeastSigma, Median(std::move(sigmas)) * std::sqrt(rows / free));

  // Unknowns of the reduced system: the steps, then c. Of each point: q, then its own matching error.
  const Eigen::Index steps = 6 * static_cast<Eigen::Index>(window.steps.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(steps + 2, steps + 2);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(steps + 2);
  for (std::size_t begin = 0; begin < all.size();) {
    Eigen::Matrix4d H_point = Eigen::Matrix4d::Zero();
    Eigen::Vector4d g_point = Eigen::Vector4d::Zero();
    Eigen::MatrixXd H_cross = Eigen::MatrixXd::Zero(4, steps + 2);
    H_point(3, 3) = 1.0 / (point_sigma_px * point_sigma_px);
    std::size_t end = begin;
    for (; end < all.size() && all[end].point == all[begin].point; ++end) {
      const Seen& seen = all[end];
      const double length = seen.residual.norm() / sigma;
      if (length > kOutlier) continue;
      const double weight = (length <= kResidualHuber ? 1.0 : kResidualHuber / length) / (sigma * sigma);
      Eigen::Matrix<double, 3, 4> J = Eigen::Matrix<double, 3, 4>::Zero();
      J.leftCols<3>() = seen.by.by_point;
      J(2, 3) = 1.0;
      Eigen::Matrix<double, 3, Eigen::Dynamic> J_rest = Eigen::MatrixXd::Zero(3, steps + 2);
      for (int k = 0; k < seen.steps; ++k) {
        J_rest.middleCols<6>(6 * (seen.host + k)) = seen.by.by_step[static_cast<std::size_t>(k)];
      }
      J_rest.block<1, 2>(2, steps) = seen.basis.transpose();
      if (seen.rows == 2) {
        J.row(2).setZero();
        J_rest.row(2).setZero();
      }
      H_point += weight * J.transpose() * J;
      g_point += weight * J.transpose() * seen.residual;
      H_cross += weight * J.transpose() * J_rest;
      H += weight * J_rest.transpose() * J_rest;
      g += weight * J_rest.transpose() * seen.residual;
    }
    begin = end;
    const Eigen::LDLT<Eigen::Matrix4d> solver(H_point);
    if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
    H -= H_cross.transpose() * solver.solve(H_cross);
    g -= H_cross.transpose() * solver.solve(g_point);
  }
  const Eigen::MatrixXd H_steps =
      H.topLeftCorner(steps, steps) + kDamping * Eigen::MatrixXd::Identity(steps, steps);
  const Eigen::LDLT<Eigen::MatrixXd> solver(H_steps);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd H_across = H.topRightCorner(steps, 2);
  BiasEvidence evidence;
  evidence.with_known_motion = H(steps, steps);
  evidence.information = H.bottomRightCorner<2, 2>() - H_across.transpose() * solver.solve(H_across);
  const Eigen::Vector2d descent = g.tail<2>() - H_across.transpose() * solver.solve(g.head(steps));
  const Eigen::Matrix2d damped = evidence.information + kDamping * Eigen::Matrix2d::Identity();
  evidence.residual = -damped.ldlt().solve(descent);
  if (!evidence.information.allFinite() || !evidence.residual.allFinite()) return std::nullopt;
  return evidence;
}

}  // namespace thalweg::visual_odometry
