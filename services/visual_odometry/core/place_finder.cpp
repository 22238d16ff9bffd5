#include "services/visual_odometry/core/place_finder.h"

#include <algorithm>
#include <cmath>

namespace thalweg::visual_odometry {
namespace {

constexpr double kExplained = 3.0;  // sigmas

}  // namespace

std::optional<SeenPlace> PlaceFinder::Agreeing(const Place& place,
                                               std::optional<LandmarkTracker::Result> result) const {
  if (!result || result->pose.inliers < options_.least_inliers || result->Share() < options_.least_share ||
      result->pose.sigma_px > options_.most_sigma_px) {
    return std::nullopt;
  }
  return SeenPlace{&place, *std::move(result)};
}

std::optional<SeenPlace> PlaceFinder::Look(const Place& place, const Sight& sight) const {
  const RigidTransform T_CP = sight.T_OC.inverse() * place.pose.T_OC;
  return Agreeing(place,
                  tracker_.Track(place.view, sight.frame, T_CP, sight.sigma_px, false, sight.use_right));
}

std::optional<SeenPlace> PlaceFinder::LookAround(const Place& place, const PlaceMemory::Reach& reach,
                                                 const Sight& sight) const {
  // Starts at the place's own position, rotated by what explains the images best.
  const cv::Mat& small = sight.frame.left[static_cast<std::size_t>(small_)];
  const Eigen::Matrix3d R_believed = (sight.T_OC.inverse() * place.pose.T_OC).linear();
  const Eigen::Matrix3d R_CP =
      BestRotation(place.small, small, small_camera_, {Eigen::Matrix3d::Identity(), R_believed});
  auto seen =
      Agreeing(place, tracker_.Track(place.view, sight.frame, MakeTransform(R_CP, Eigen::Vector3d::Zero()),
                                     sight.sigma_px, true, sight.use_right));
  if (!seen) return std::nullopt;
  const RigidTransform T_OC = seen->T_OC();
  const double distance = (T_OC.translation() - sight.T_OC.translation()).norm();
  if (distance > reach.distance || AngleBetween(T_OC, sight.T_OC) > reach.turn) return std::nullopt;
  return seen;
}

bool PlaceFinder::Same(const Belief& a, const Belief& b) const {
  // The error of the more certain of the two is common to both.
  const auto explained = [](double sigma, double other) {
    return kExplained * std::sqrt(std::abs(sigma * sigma - other * other));
  };
  return (a.T_OC.translation() - b.T_OC.translation()).norm() <=
             options_.same_position + explained(PositionSigma(a.covariance), PositionSigma(b.covariance)) &&
         AngleBetween(a.T_OC, b.T_OC) <=
             options_.same_turn + explained(RotationSigma(a.covariance), RotationSigma(b.covariance));
}

PlaceFinder::Found PlaceFinder::Search(const PlaceMemory& places, const PlaceMemory::Reach& reach,
                                       const Sight& sight, const Belief* own) const {
  std::vector<SeenPlace> seen;
  std::vector<Belief> beliefs;
  const cv::Mat& small = sight.frame.left[static_cast<std::size_t>(small_)];
  for (const Place* place : places.MostAlike(small, sight.T_OC, reach, options_.most_tried)) {
    auto one = LookAround(*place, reach, sight);
    if (!one) continue;
    beliefs.push_back({one->T_OC(), place->pose.covariance, one->result.Share()});
    seen.push_back(*std::move(one));
  }
  if (own != nullptr) beliefs.push_back(*own);
  if (beliefs.empty()) return {};
  const auto best = std::ranges::max_element(beliefs, {}, &Belief::share);
  const bool disputed = std::ranges::any_of(beliefs, [&](const Belief& other) {
    return other.share >= options_.rival_share * best->share && !Same(other, *best);
  });
  const auto index = static_cast<std::size_t>(best - beliefs.begin());
  if (disputed || index == seen.size()) return {{}, disputed};
  return {std::move(seen[index]), false};
}

}  // namespace thalweg::visual_odometry
