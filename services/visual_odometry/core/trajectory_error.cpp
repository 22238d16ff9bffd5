#include "services/visual_odometry/core/trajectory_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace thalweg::visual_odometry {
namespace {

constexpr double kChiSquare3 = 7.815;  // 95 %, three degrees of freedom

std::vector<double> DistancesAlong(const std::vector<PosePair>& poses) {
  std::vector<double> distances{0.0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    distances.push_back(distances.back() +
                        (poses[i].T_WC_true.translation() - poses[i - 1].T_WC_true.translation()).norm());
  }
  return distances;
}

std::vector<double> LengthsFor(double path_length) {
  const double unit = path_length >= 100.0 ? 100.0 : path_length >= 10.0 ? 10.0 : 1.0;
  std::vector<double> lengths;
  for (int k = 1; k <= 8 && k * unit <= path_length; ++k) lengths.push_back(k * unit);
  return lengths;
}

/// Absolute errors after the least-squares rotation and translation.
void AlignAndMeasure(const std::vector<PosePair>& poses, TrajectoryError& error) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  Eigen::Matrix3Xd estimate(3, count);
  Eigen::Matrix3Xd truth(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    estimate.col(i) = poses[static_cast<std::size_t>(i)].T_OC.translation();
    truth.col(i) = poses[static_cast<std::size_t>(i)].T_WC_true.translation();
  }
  const Eigen::Matrix4d T_WO = Eigen::umeyama(estimate, truth, false);
  const Eigen::Matrix3Xd aligned =
      (T_WO.topLeftCorner<3, 3>() * estimate).colwise() + Eigen::Vector3d(T_WO.topRightCorner<3, 1>());
  const Eigen::VectorXd distances = (aligned - truth).colwise().norm();
  error.ate_rmse = std::sqrt(distances.squaredNorm() / static_cast<double>(count));
  error.ate_max = distances.maxCoeff();
}

void MeasureDrift(const std::vector<PosePair>& poses, TrajectoryError& error) {
  const RigidTransform T_WO = poses.front().T_WC_true * poses.front().T_OC.inverse();
  for (const PosePair& pose : poses) {
    error.drift = ((T_WO * pose.T_OC).translation() - pose.T_WC_true.translation()).norm();
    error.drift_max = std::max(error.drift_max, error.drift);
  }
  error.drift_angle = AngleBetween(T_WO * poses.back().T_OC, poses.back().T_WC_true);
}

void MeasureConsistency(const std::vector<PosePair>& poses, TrajectoryError& error) {
  const RigidTransform T_OW = poses.front().T_OC * poses.front().T_WC_true.inverse();
  int count = 0, positions = 0, rotations = 0;
  for (const PosePair& pose : poses) {
    if (pose.covariance.diagonal().minCoeff() <= 0.0) continue;
    const Inside inside = InsideOf95Percent(pose.T_OC.inverse() * T_OW * pose.T_WC_true, pose.covariance);
    ++count;
    positions += inside.position ? 1 : 0;
    rotations += inside.rotation ? 1 : 0;
  }
  const auto share = [&](int of) {
    return count > 0 ? static_cast<double>(of) / count : std::numeric_limits<double>::quiet_NaN();
  };
  error.inside_position = share(positions);
  error.inside_rotation = share(rotations);
}

}  // namespace

Inside InsideOf95Percent(const RigidTransform& error, const Matrix6d& covariance) {
  const auto inside = [](const Eigen::Vector3d& e, const Eigen::Matrix3d& of) {
    return e.dot(of.ldlt().solve(e)) < kChiSquare3;
  };
  return {inside(error.translation(), covariance.topLeftCorner<3, 3>()),
          inside(VectorFromRotation(error.linear()), covariance.bottomRightCorner<3, 3>())};
}

TrajectoryError Compare(const std::vector<PosePair>& poses) {
  if (poses.size() < 2) throw std::invalid_argument("a trajectory error needs two poses or more");
  const std::vector<double> distances = DistancesAlong(poses);
  TrajectoryError error;
  error.poses = static_cast<int>(poses.size());
  error.path_length = distances.back();
  AlignAndMeasure(poses, error);
  MeasureDrift(poses, error);
  MeasureConsistency(poses, error);

  double translation = 0.0;
  double rotation = 0.0;
  int stretches = 0;
  for (const double length : LengthsFor(error.path_length)) {
    RelativeError relative{.length = length};
    for (std::size_t first = 0; first < poses.size(); ++first) {
      const auto end = std::lower_bound(distances.begin(), distances.end(), distances[first] + length);
      if (end == distances.end()) break;
      const auto last = static_cast<std::size_t>(end - distances.begin());
      const RigidTransform estimated = poses[first].T_OC.inverse() * poses[last].T_OC;
      const RigidTransform truth = poses[first].T_WC_true.inverse() * poses[last].T_WC_true;
      const RigidTransform difference = estimated.inverse() * truth;
      relative.translation += difference.translation().norm() / length;
      relative.rotation += AngleBetween(estimated, truth) / length;
      ++relative.stretches;
    }
    if (relative.stretches == 0) continue;
    translation += relative.translation;
    rotation += relative.rotation;
    stretches += relative.stretches;
    relative.translation /= relative.stretches;
    relative.rotation /= relative.stretches;
    error.by_length.push_back(relative);
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  error.relative_translation = stretches > 0 ? translation / stretches : none;
  error.relative_rotation = stretches > 0 ? rotation / stretches : none;
  return error;
}

}  // namespace thalweg::visual_odometry
