#include "services/visual_odometry/core/place_memory.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/base/median.h"

namespace thalweg::visual_odometry {
namespace {

constexpr double kLeastInverseDepth = 1e-3;  // [1/m]
constexpr double kMuchSurer = 3.0;           // times: the place is seen anew
/// Squared Mahalanobis distance of six dimensions: 1 in 1000 is beyond 22.5. Drift is no white noise, its
/// covariance too small by some: so three sigmas of that again.
constexpr double kContradiction = 9.0 * 22.5;

/// What `now` has more than `then`, 0 in directions in which it has less: at most `now`, in whatever units.
Matrix6d Growth(const Matrix6d& then, const Matrix6d& now) {
  const Eigen::LLT<Matrix6d> root(now);
  if (root.info() != Eigen::Success) return Matrix6d::Zero();
  const Matrix6d L = root.matrixL();
  const Matrix6d L_inverse = L.triangularView<Eigen::Lower>().solve(Matrix6d::Identity());
  const Matrix6d share = L_inverse * then * L_inverse.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(0.5 * (share + share.transpose()));
  const Vector6d grown = (Vector6d::Ones() - solver.eigenvalues()).cwiseMax(0.0);
  const Matrix6d axes = L * solver.eigenvectors();
  return axes * grown.asDiagonal() * axes.transpose();
}

}  // namespace

double PlaceMemory::Overlap(const Place& place, const RigidTransform& T_OC) const {
  const RigidTransform T_CP = T_OC.inverse() * place.pose.T_OC;
  // Most places are out of sight altogether.
  if (AngleBetween(T_CP, RigidTransform::Identity()) > 2.0 * options_.most_slant) return 0.0;
  const Eigen::Vector3d C_P = T_CP.inverse().translation();
  if (C_P.norm() > place.depth) return 0.0;
  const double least_cos = std::cos(options_.most_slant);
  std::size_t seen = 0;
  for (const Landmark& landmark : place.view.landmarks()) {
    const InverseDepthPoint& q = landmark.q_K;
    const Eigen::Vector3d m = ScaledTransform(T_CP, q);  // by its depth in P
    if (m.z() < std::max(kLeastForward, options_.least_depth_ratio) || m.z() > options_.most_depth_ratio) {
      continue;
    }
    if (!rig_.camera.Sees(m)) continue;
    const Eigen::Vector3d ray_P(q[0], q[1], 1.0);
    const Eigen::Vector3d ray_C = ray_P - q[2] * C_P;  // from C, in P's axes
    if (ray_P.dot(ray_C) < least_cos * ray_P.norm() * ray_C.norm()) continue;
    ++seen;
  }
  return static_cast<double>(seen) / static_cast<double>(place.view.landmarks().size());
}

void PlaceMemory::Remember(const KnownPose& pose, const KeyframeWindow& window, const cv::Mat& small,
                           std::int64_t serial) {
  if (options_.most_places == 0) return;
  const auto same = [&](const Place& other) { return Overlap(other, pose.T_OC) >= options_.new_overlap; };
  const double enough = kMuchSurer * PositionSigma(pose.covariance);
  if (std::ranges::any_of(places_, [&](const Place& other) {
        return PositionSigma(other.pose.covariance) <= enough && same(other);
      })) {
    return;
  }
  Place place{pose, window.Newest(), small.clone(), 0.0, serial};
  const std::vector<Landmark>& landmarks = place.view.landmarks();
  if (static_cast<int>(landmarks.size()) < options_.least_points) return;
  std::vector<double> depths;
  for (const Landmark& landmark : landmarks)
    depths.push_back(1.0 / std::max(landmark.q_K[2], kLeastInverseDepth));
  place.depth = Median(std::move(depths));
  std::erase_if(places_, same);
  if (static_cast<int>(places_.size()) >= options_.most_places) {
    const auto way = [&](const Place& other) {
      return (other.pose.T_OC.translation() - pose.T_OC.translation()).squaredNorm();
    };
    places_.erase(std::ranges::max_element(places_, {}, way));
  }
  places_.push_back(std::move(place));
}

const Place* PlaceMemory::InView(const RigidTransform& T_OC, std::int64_t before) const {
  const Place* best = nullptr;
  for (const Place& place : places_) {
    if (place.serial >= before) continue;
    if (best != nullptr && PositionSigma(place.pose.covariance) >= PositionSigma(best->pose.covariance))
      continue;
    if (Overlap(place, T_OC) >= options_.least_overlap) best = &place;
  }
  return best;
}

std::vector<const Place*> PlaceMemory::Near(const RigidTransform& T_OC, double reach, double turn,
                                            double most_sigma) const {
  std::vector<const Place*> near;
  const auto way = [&](const Place* place) {
    return (place->pose.T_OC.translation() - T_OC.translation()).norm();
  };
  for (const Place& place : places_) {
    if (PositionSigma(place.pose.covariance) > most_sigma) continue;
    if (way(&place) <= reach && AngleBetween(place.pose.T_OC, T_OC) <= turn) near.push_back(&place);
  }
  std::ranges::stable_sort(near, {}, way);
  return near;
}

std::optional<KnownPose> Corrected(const KnownPose& camera, const KnownPose& place,
                                   const RigidTransform& T_CP, const Matrix6d& covariance_CP) {
  // All of x in T_OC_true = T_OC * Moved(x, identity).
  const RigidTransform T_CC = camera.T_OC.inverse() * place.T_OC * T_CP.inverse();
  Vector6d difference;
  difference << T_CC.translation(), VectorFromRotation(T_CC.linear());
  const Matrix6d adjoint = Adjoint(T_CP);
  const Matrix6d since = Growth(adjoint * place.covariance * adjoint.transpose(), camera.covariance);
  const Eigen::LDLT<Matrix6d> both((since + covariance_CP).eval());
  if (difference.dot(both.solve(difference)) > kContradiction) return std::nullopt;
  const Vector6d step = since * both.solve(difference);
  KnownPose corrected;
  corrected.T_OC = camera.T_OC * Moved(step, RigidTransform::Identity());
  corrected.covariance = camera.covariance - since * both.solve(since);
  corrected.covariance = (0.5 * (corrected.covariance + corrected.covariance.transpose())).eval();
  return corrected;
}

}  // namespace thalweg::visual_odometry
