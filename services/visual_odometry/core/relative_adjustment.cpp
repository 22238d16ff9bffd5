#include "services/visual_odometry/core/relative_adjustment.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/check.h"

namespace thalweg::visual_odometry {
namespace {

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

}  // namespace thalweg::visual_odometry
