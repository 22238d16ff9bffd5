#include "services/visual_odometry/core/place_memory.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/base/median.h"

namespace thalweg::visual_odometry {
namespace {

constexpr int kThumbnailColumns = 20;
constexpr int kLeastRows = 4;
constexpr double kLeastDeviation = 1.0;      // [gray values] of a thumbnail that is not blank
constexpr double kLeastInverseDepth = 1e-3;  // [1/m]
constexpr double kMuchSurer = 3.0;           // ratio of sigmas at which a place is replaced
/// Squared Mahalanobis distance in six dimensions: 1 in 1000 lies beyond 22.5. Drift is not white noise, and
/// its covariance is somewhat too small, so that distances up to three times as large are accepted.
constexpr double kContradiction = 9.0 * 22.5;

/// The part by which `now` exceeds `then`; 0 in directions in which it is smaller. Never exceeds `now`,
/// whatever the units.
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

/// Covariance of the mean of two estimates with these covariances. Half of the error of a look at a place
/// belongs to the place itself and is the same at each look, so that half remains however often the place is
/// seen.
Matrix6d Fused(const Matrix6d& since, const Matrix6d& look) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> solver(since, look);
  const auto fused = [](double ratio) { return std::max(ratio / (1.0 + ratio), std::min(ratio, 0.5)); };
  const Vector6d ratios = solver.eigenvalues().cwiseMax(0.0).unaryExpr(fused);
  const Matrix6d axes = look * solver.eigenvectors();  // look^-1 = eigenvectors * eigenvectors^T
  return axes * ratios.asDiagonal() * axes.transpose();
}

}  // namespace

double PlaceMemory::Overlap(const Place& place, const RigidTransform& T_OC) const {
  const RigidTransform T_CP = T_OC.inverse() * place.pose.T_OC;
  // Most places are entirely out of view.
  if (AngleBetween(T_CP, RigidTransform::Identity()) > 2.0 * options_.most_slant) return 0.0;
  const Eigen::Vector3d C_P = T_CP.inverse().translation();
  if (C_P.norm() > place.depth) return 0.0;
  const double least_cos = std::cos(options_.most_slant);
  std::size_t seen = 0;
  for (const Landmark& landmark : place.view.landmarks()) {
    const InverseDepthPoint& q = landmark.q_K;
    const Eigen::Vector3d m = ScaledTransform(T_CP, q);  // divided by its depth in P
    if (m.z() < std::max(kLeastForward, options_.least_depth_ratio) || m.z() > options_.most_depth_ratio) {
      continue;
    }
    if (!rig_.camera.Sees(m)) continue;
    const Eigen::Vector3d ray_P(q[0], q[1], 1.0);
    const Eigen::Vector3d ray_C = ray_P - q[2] * C_P;  // ray from C, in P's axes
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
  Place place{pose, window.Newest(), small.clone(), Thumbnail(small), 0.0, serial};
  const std::vector<Landmark>& landmarks = place.view.landmarks();
  if (static_cast<int>(landmarks.size()) < options_.least_points) return;
  std::vector<double> depths;
  for (const Landmark& landmark : landmarks)
    depths.push_back(1.0 / std::max(landmark.q_K[2], kLeastInverseDepth));
  place.depth = Median(std::move(depths));
  std::erase_if(places_, same);
  if (static_cast<int>(places_.size()) >= options_.most_places) {
    const auto squared_distance = [&](const Place& other) {
      return (other.pose.T_OC.translation() - pose.T_OC.translation()).squaredNorm();
    };
    places_.erase(std::ranges::max_element(places_, {}, squared_distance));
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

std::vector<const Place*> PlaceMemory::MostAlike(const cv::Mat& small, const RigidTransform& T_OC,
                                                 const Reach& reach, std::size_t most) const {
  const cv::Mat thumbnail = Thumbnail(small);
  std::vector<std::pair<double, const Place*>> alike;
  for (const Place& place : places_) {
    const RigidTransform& T_OP = place.pose.T_OC;
    if ((T_OP.translation() - T_OC.translation()).norm() > reach.distance ||
        AngleBetween(T_OP, T_OC) > reach.turn) {
      continue;
    }
    alike.emplace_back(-Likeness(place.thumbnail, thumbnail), &place);
  }
  std::ranges::stable_sort(alike, {}, &std::pair<double, const Place*>::first);
  std::vector<const Place*> found;
  for (std::size_t n = 0; n < std::min(most, alike.size()); ++n) found.push_back(alike[n].second);
  return found;
}

cv::Mat Thumbnail(const cv::Mat& image) {
  cv::Mat thumbnail;
  const int rows = std::max(kLeastRows, kThumbnailColumns * image.rows / image.cols);
  cv::resize(image, thumbnail, cv::Size(kThumbnailColumns, rows), 0, 0, cv::INTER_AREA);
  return thumbnail;
}

double Likeness(const cv::Mat& thumbnail, const cv::Mat& other) {
  const int columns = thumbnail.cols / 4;
  const int rows = thumbnail.rows / 4;
  const cv::Rect middle(columns, rows, thumbnail.cols - 2 * columns, thumbnail.rows - 2 * rows);
  cv::Scalar mean, deviation;
  cv::meanStdDev(thumbnail(middle), mean, deviation);
  if (deviation[0] < kLeastDeviation) return 0.0;
  cv::Mat correlation;
  cv::matchTemplate(other, thumbnail(middle), correlation, cv::TM_CCOEFF_NORMED);
  double best = 0.0;
  cv::minMaxLoc(correlation, nullptr, &best);
  return best;
}

Matrix6d BiasTrace::Moment(const StereoBiasMonitor& monitor) const {
  const Vector6d mean = by_bias * monitor.mean();
  return by_bias * monitor.second_moment() * by_bias.transpose() - mean * removed.transpose() -
         removed * mean.transpose() + removed * removed.transpose();
}

std::optional<KnownPose> Corrected(const KnownPose& camera, const KnownPose& place,
                                   const RigidTransform& T_CP, const Matrix6d& covariance_CP,
                                   const BiasTrace& bias_CP, const StereoBiasMonitor& monitor) {
  // All of them are about x in T_OC_true = T_OC * Moved(x, identity).
  const RigidTransform T_CC = camera.T_OC.inverse() * place.T_OC * T_CP.inverse();
  Vector6d difference;
  difference << T_CC.translation(), VectorFromRotation(T_CC.linear());
  const Matrix6d adjoint = Adjoint(T_CP);
  const Matrix6d since = Growth(adjoint * place.covariance * adjoint.transpose(), camera.covariance);
  const BiasTrace bias_since{camera.bias.by_bias - (adjoint * place.bias.by_bias - bias_CP.by_bias),
                             camera.bias.removed - (adjoint * place.bias.removed - bias_CP.removed)};
  const Matrix6d drift = since + bias_since.Moment(monitor);
  const Eigen::LDLT<Matrix6d> both((drift + covariance_CP).eval());
  if (difference.dot(both.solve(difference)) > kContradiction) return std::nullopt;
  const Vector6d step = drift * both.solve(difference);
  // What is left of the drift since then, systematic as random, is the share that the step does not take.
  const Matrix6d left = Matrix6d::Identity() - drift * both.solve(Matrix6d::Identity());
  KnownPose corrected;
  corrected.bias.by_bias = camera.bias.by_bias - (Matrix6d::Identity() - left) * bias_since.by_bias;
  corrected.bias.removed = camera.bias.removed - (Matrix6d::Identity() - left) * bias_since.removed;
  corrected.T_OC = camera.T_OC * Moved(step, RigidTransform::Identity());
  corrected.covariance = camera.covariance - since + Fused(since, covariance_CP);
  return corrected;
}

}  // namespace thalweg::visual_odometry
