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
  // As if the camera stood where it did then, turned by what explains the images best.
  const cv::Mat& small = sight.frame.left[static_cast<std::size_t>(small_)];
  const Eigen::Matrix3d R_believed = (sight.T_OC.inverse() * place.pose.T_OC).linear();
  const Eigen::Matrix3d R_CP =
      BestRotation(place.small, small, small_camera_, {Eigen::Matrix3d::Identity(), R_believed});
  auto seen =
      Agreeing(place, tracker_.Track(place.view, sight.frame, MakeTransform(R_CP, Eigen::Vector3d::Zero()),
                                     sight.sigma_px, true, sight.use_right));
  if (!seen) return std::nullopt;
  const RigidTransform T_OC = seen->T_OC();
  const double way = (T_OC.translation() - sight.T_OC.translation()).norm();
  if (way > reach.way || AngleBetween(T_OC, sight.T_OC) > reach.turn) return std::nullopt;
  return seen;
}

bool PlaceFinder::HasRival(const RigidTransform& T_OC, double sigma, double share, const PlaceMemory& places,
                           const PlaceMemory::Reach& reach, const Sight& sight) const {
  const auto is_rival = [&](const Place* place) {
    if (places.InSight(*place, T_OC)) return false;  // it would say the same
    const auto other = LookAround(*place, reach, sight);
    if (!other || other->result.Share() < options_.rival_share * share) return false;
    const double explained = kExplained * std::hypot(sigma, PositionSigma(place->pose.covariance));
    const RigidTransform T_OC_other = other->T_OC();
    return (T_OC_other.translation() - T_OC.translation()).norm() > options_.same_way + explained ||
           AngleBetween(T_OC_other, T_OC) > options_.same_turn;
  };
  const cv::Mat& small = sight.frame.left[static_cast<std::size_t>(small_)];
  return std::ranges::any_of(places.MostAlike(small, sight.T_OC, reach, options_.most_rivals), is_rival);
}

PlaceFinder::Found PlaceFinder::Search(const PlaceMemory& places, const PlaceMemory::Reach& reach,
                                       const Sight& sight) const {
  const cv::Mat& small = sight.frame.left[static_cast<std::size_t>(small_)];
  for (const Place* place : places.MostAlike(small, sight.T_OC, reach, options_.most_tried)) {
    auto seen = LookAround(*place, reach, sight);
    if (!seen) continue;
    const double sigma = PositionSigma(place->pose.covariance);
    if (HasRival(seen->T_OC(), sigma, seen->result.Share(), places, reach, sight)) return {{}, true};
    return {std::move(seen), false};
  }
  return {};
}

}  // namespace thalweg::visual_odometry
