#pragma once

#include <optional>
#include <vector>

#include "services/visual_odometry/core/keyframe_window.h"

namespace thalweg::visual_odometry {

/// What a systematic error c of the disparities did to a pose on the way since the start: its error x,
/// defined as in PoseEstimate, has the part by_bias * c - removed, which is not random along the path.
struct BiasTrace {
  Matrix62d by_bias = Matrix62d::Zero();
  Vector6d removed = Vector6d::Zero();  ///< What the corrections on the way have removed.

  /// Mean of its square, for what is believed about c now.
  Matrix6d Moment(const StereoBiasMonitor& monitor) const;
};

/// Pose of a camera in O; the covariance is defined as in PoseEstimate.
struct KnownPose {
  RigidTransform T_OC;
  Matrix6d covariance;  ///< From random errors alone.
  BiasTrace bias{};
};

/// A keyframe that is kept permanently: a camera that recognizes its points knows its own pose as well as the
/// keyframe's pose was known. O as in PoseEstimate; P is the keyframe's camera.
struct Place {
  KnownPose pose;       ///< T_OP. Never changed, since the map was built with it.
  KeyframeWindow view;  ///< A window of that keyframe alone.
  cv::Mat small;        ///< Its left image at Levels::small.
  cv::Mat thumbnail;
  double depth = 0.0;       ///< [m] Median depth of its points.
  std::int64_t serial = 0;  ///< Number of keyframes made before it.
};

/// The places seen so far, few enough to be searched one by one.
///
/// Threading: one thread.
class PlaceMemory {
 public:
  struct Options {
    int most_places = 600;  ///< At 320 x 240 pixels each takes 0.25 MB. 0 = none are kept.
    int least_points = 30;  ///< A keyframe with fewer points could not be recognized.
    /// A place is in view of a camera if this share of its points is: within the image,
    double least_overlap = 0.5;
    double least_depth_ratio = 0.6;  ///< at a similar depth,
    double most_depth_ratio = 1.7;
    double most_slant = 0.6;   ///< [rad] and from a similar direction.
    double new_overlap = 0.7;  ///< A keyframe that overlaps less with every place becomes one.
  };
  PlaceMemory(const StereoGeometry& rig, const Options& options) : rig_(rig), options_(options) {}

  /// Keeps the keyframe unless it resembles a place already kept. Replaces that place instead if its pose is
  /// at least three times less certain. If there are too many places, drops the farthest.
  void Remember(const KnownPose& pose, const KeyframeWindow& window, const cv::Mat& small,
                std::int64_t serial);
  /// The place, among those that the camera should see, whose pose is known best; null if there is none.
  /// @param before  Only places from earlier keyframes are considered.
  const Place* InView(const RigidTransform& T_OC, std::int64_t before) const;
  struct Reach {
    double distance = 0.0;  ///< [m] The largest.
    double turn = 0.0;      ///< [rad] The largest.
  };
  /// The places within reach of a camera whose pose is hardly known that resemble its image most, the most
  /// similar first.
  std::vector<const Place*> MostAlike(const cv::Mat& small, const RigidTransform& T_OC, const Reach& reach,
                                      std::size_t most) const;
  /// Share of a place's points that a camera at T_OC sees much as the place did.
  double Overlap(const Place& place, const RigidTransform& T_OC) const;
  std::size_t size() const { return places_.size(); }

 private:
  StereoGeometry rig_;
  Options options_;
  std::vector<Place> places_;
};

/// Scales an image down to 20 columns.
/// @param image  CV_8UC1.
cv::Mat Thumbnail(const cv::Mat& image);
/// Similarity of two thumbnails of equal size, regardless of brightness, contrast and a rotation by up to a
/// quarter of the field of view: the best normalized correlation of the middle of one thumbnail with the
/// other.
/// @return -1 to 1; 0 if the middle is blank.
double Likeness(const cv::Mat& thumbnail, const cv::Mat& other);

/// Corrects a camera's pose when it recognizes a place: the mean of both, weighted by their covariances. The
/// covariance of the drift since the place was kept is taken as the growth of the pose's covariance;
/// directions without growth are not corrected.
/// @param T_CP  As measured, with
/// @param covariance_CP  its covariance and
/// @param bias_CP  what the bias of disparities did to it.
/// @param monitor  What is believed about that bias, which may explain a difference, too.
/// @return Nothing if the two contradict each other.
std::optional<KnownPose> Corrected(const KnownPose& camera, const KnownPose& place,
                                   const RigidTransform& T_CP, const Matrix6d& covariance_CP,
                                   const BiasTrace& bias_CP, const StereoBiasMonitor& monitor);

}  // namespace thalweg::visual_odometry
