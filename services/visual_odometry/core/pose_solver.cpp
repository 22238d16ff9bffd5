#include "services/visual_odometry/core/pose_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>
#include <utility>

#include "common/base/median.h"
#include "services/visual_odometry/core/robust_sigma.h"

namespace thalweg::visual_odometry {
namespace {

constexpr int kMostPoseSteps = 10;
constexpr double kPointHuber = 2.5;  // in sigmas of residuals in three dimensions
constexpr double kFarthest = 1e3;  // [baselines] for points of a hypothesis, whose solver needs finite points

RigidTransform FromOpenCv(const cv::Mat& rvec, const cv::Mat& tvec) {
  const Eigen::Vector3d w(rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2));
  const Eigen::Vector3d t(tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2));
  return MakeTransform(RotationFromVector(w), t);
}

/// The poses from which the three points appear where they were seen.
std::vector<RigidTransform> Hypotheses(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                       const std::array<std::size_t, 3>& chosen) {
  cv::Mat object(3, 3, CV_64F);
  cv::Mat image(3, 2, CV_64F);
  for (int i = 0; i < 3; ++i) {
    const PosePoint& point = points[chosen[static_cast<std::size_t>(i)]];
    const double z = 1.0 / point.q_K[2];
    object.at<double>(i, 0) = point.q_K[0] * z;
    object.at<double>(i, 1) = point.q_K[1] * z;
    object.at<double>(i, 2) = z;
    image.at<double>(i, 0) = (point.pixel[0] - rig.camera.cx) / rig.camera.fx;
    image.at<double>(i, 1) = (point.pixel[1] - rig.camera.cy) / rig.camera.fy;
  }
  std::vector<cv::Mat> rvecs;
  std::vector<cv::Mat> tvecs;
  cv::solveP3P(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rvecs, tvecs, cv::SOLVEPNP_AP3P);
  std::vector<RigidTransform> poses;
  for (std::size_t k = 0; k < rvecs.size(); ++k) {
    if (cv::checkRange(rvecs[k]) && cv::checkRange(tvecs[k])) poses.push_back(FromOpenCv(rvecs[k], tvecs[k]));
  }
  return poses;
}

bool SeenWhere(const StereoGeometry& rig, const PosePoint& point, const RigidTransform& T_CK,
               double threshold) {
  const Eigen::Vector3d m = ScaledTransform(T_CK, point.q_K);
  if (m.z() <= 0.01) return false;
  const Eigen::Vector3d seen = ProjectScaled(rig, m, point.q_K[2]);
  return (seen - point.pixel).head<2>().squaredNorm() < threshold * threshold;
}

/// The constraint of one point on the pose, whitened: its residual has unit variance if the pixel error is 1
/// px.
struct Whitened {
  Eigen::Matrix<double, 3, 6> jacobian;
  Eigen::Matrix3d lower;  ///< Square root of the covariance for pixel errors of 1 px.
  Eigen::Vector3d residual;
  int rows = 0;  ///< Number of rows that count, 2 or 3.
  double distance = 0.0;
};

std::optional<Whitened> Whiten(const StereoGeometry& rig, const PosePoint& point,
                               const RigidTransform& T_CK) {
  const Eigen::Vector3d m = ScaledTransform(T_CK, point.q_K);
  if (m.z() <= 0.01) return std::nullopt;
  const Eigen::Matrix3d by_point = PointJacobian(rig, T_CK, point.q_K);
  Eigen::Matrix3d covariance =
      by_point * point.q_covariance * by_point.transpose() + Eigen::Matrix3d::Identity();
  Whitened whitened;
  whitened.rows = point.has_right ? 3 : 2;
  if (!point.has_right) {
    covariance.row(2).setZero();
    covariance.col(2).setZero();
    covariance(2, 2) = 1.0;
  }
  const Eigen::Matrix3d lower = covariance.llt().matrixL();
  whitened.lower = lower;
  whitened.jacobian = lower.triangularView<Eigen::Lower>().solve(PoseJacobian(rig, T_CK, point.q_K));
  whitened.residual =
      lower.triangularView<Eigen::Lower>().solve(ProjectScaled(rig, m, point.q_K[2]) - point.pixel);
  if (!point.has_right) {
    whitened.jacobian.row(2).setZero();
    whitened.residual[2] = 0.0;
  }
  whitened.distance = whitened.residual.norm();
  return whitened;
}

/// d residual / d c of the same residual: the point's inverse depth was triangulated in K, and the right
/// pixel is seen in C, with the same bias.
Eigen::Matrix<double, 3, 2> ResidualByBias(const StereoGeometry& rig, const PosePoint& point,
                                           const RigidTransform& T_CK) {
  const PinholeCamera& camera = rig.camera;
  const double u_right_K = camera.fx * (point.q_K[0] - rig.baseline * point.q_K[2]) + camera.cx;
  Eigen::Matrix<double, 3, 2> by_bias =
      PointJacobian(rig, T_CK, point.q_K).col(2) * InverseDepthByBias(rig, u_right_K);
  if (point.has_right) by_bias.row(2) += BiasBasis(camera, point.pixel[2]).transpose();
  return by_bias;
}

}  // namespace

std::optional<Consensus> FindConsensus(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                       const RigidTransform& T_CK_predicted, const PoseSolverOptions& options,
                                       std::uint64_t seed) {
  if (points.size() < 4) return std::nullopt;
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].q_K[2] * rig.baseline > 1.0 / kFarthest) usable.push_back(i);
  }
  Consensus best;
  const auto judge = [&](const RigidTransform& T_CK) {
    int inliers = 0;
    for (const PosePoint& point : points) inliers += SeenWhere(rig, point, T_CK, options.ransac_threshold_px);
    if (inliers <= best.inliers) return;
    best.inliers = inliers;
    best.T_CK = T_CK;
  };
  judge(T_CK_predicted);
  std::mt19937_64 random(seed);
  int needed = options.most_hypotheses;
  for (int k = 0; k < needed && usable.size() >= 3; ++k) {
    std::array<std::size_t, 3> chosen{};
    for (std::size_t i = 0; i < 3; ++i) {  // a partial Fisher-Yates shuffle: three distinct points
      const std::size_t j = i + random() % (usable.size() - i);
      std::swap(usable[i], usable[j]);
      chosen[i] = usable[i];
    }
    for (const RigidTransform& T_CK : Hypotheses(rig, points, chosen)) judge(T_CK);
    // Enough that, with a probability of 99.9 %, one sample consisted of inliers only.
    const double share = static_cast<double>(best.inliers) / static_cast<double>(points.size());
    const double all_good = share * share * share;
    if (all_good >= 0.999) break;
    if (all_good > 0.0) {
      needed =
          std::min(options.most_hypotheses, 10 + static_cast<int>(std::log(1e-3) / std::log(1.0 - all_good)));
    }
  }
  if (best.inliers < 4) return std::nullopt;
  for (const PosePoint& point : points) {
    best.inlier.push_back(SeenWhere(rig, point, best.T_CK, options.ransac_threshold_px) ? 1 : 0);
  }
  return best;
}

std::optional<PoseSolution> SolvePose(const StereoGeometry& rig, const std::vector<PosePoint>& points,
                                      const RigidTransform& T_CK_start, double sigma_px,
                                      const PoseSolverOptions& options) {
  PoseSolution solution;
  solution.T_CK = T_CK_start;
  double sigma = std::max(sigma_px, options.least_sigma_px);
  Matrix6d information;
  for (int step = 0; step < kMostPoseSteps; ++step) {
    information.setZero();
    Vector6d descent = Vector6d::Zero();
    std::vector<double> sigmas;
    for (const PosePoint& point : points) {
      const auto whitened = Whiten(rig, point, solution.T_CK);
      if (!whitened) continue;
      sigmas.push_back(SigmaByLength(whitened->distance, whitened->rows));
      if (step >= kMostPoseSteps / 2 && whitened->distance > options.gate * sigma) continue;
      const double bound = kPointHuber * sigma;
      const double weight = whitened->distance <= bound ? 1.0 : bound / whitened->distance;
      information += weight * whitened->jacobian.transpose() * whitened->jacobian;
      descent += weight * whitened->jacobian.transpose() * whitened->residual;
    }
    if (sigmas.size() < 4) return std::nullopt;
    sigma = std::max(options.least_sigma_px, Median(std::move(sigmas)));
    const Eigen::LDLT<Matrix6d> solver(information);
    if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
    const Vector6d move = -solver.solve(descent);
    if (!move.allFinite()) return std::nullopt;
    solution.T_CK = Moved(move, solution.T_CK);
    if (step >= kMostPoseSteps / 2 && move.norm() < 1e-9) break;
  }
  information.setZero();
  Matrix62d descent_by_bias = Matrix62d::Zero();
  Eigen::Vector2d pulled = Eigen::Vector2d::Zero();
  double squares = 0.0;
  for (const PosePoint& point : points) {
    const auto whitened = Whiten(rig, point, solution.T_CK);
    const bool inlier = whitened && whitened->distance <= options.gate * sigma;
    solution.inlier.push_back(inlier ? 1 : 0);
    if (!inlier) continue;
    ++solution.inliers;
    information += whitened->jacobian.transpose() * whitened->jacobian;
    Eigen::Matrix<double, 3, 2> by_bias =
        whitened->lower.triangularView<Eigen::Lower>().solve(ResidualByBias(rig, point, solution.T_CK));
    if (!point.has_right) by_bias.row(2).setZero();
    descent_by_bias += whitened->jacobian.transpose() * by_bias;
    const double disparity = rig.camera.fx * rig.baseline * point.q_K[2];
    const double u_right = rig.camera.fx * point.q_K[0] + rig.camera.cx - disparity;
    pulled += disparity * BiasBasis(rig.camera, u_right);
    squares += disparity * disparity;
  }
  const Eigen::LDLT<Matrix6d> solver(information);
  if (solution.inliers < 4 || solver.info() != Eigen::Success ||
      solver.vectorD().minCoeff() < 1e-9 * solver.vectorD().maxCoeff()) {
    return std::nullopt;
  }
  solution.sigma_px = sigma;
  solution.covariance = sigma * sigma * solver.solve(Matrix6d::Identity());
  solution.by_bias = -solver.solve(descent_by_bias);
  if (squares > 0.0) solution.scale_by_bias = pulled / squares;
  return solution;
}

}  // namespace thalweg::visual_odometry
