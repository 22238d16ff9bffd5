#pragma once

#include <optional>
#include <vector>

#include "services/visual_odometry/core/keyframe_window.h"

namespace thalweg::visual_odometry {

/// Of a camera in O; covariance as PoseEstimate has it.
struct KnownPose {
  RigidTransform T_OC;
  Matrix6d covariance;
};

/// A keyframe that is kept for good: a camera that sees its points again knows where it is as well as that
/// keyframe did. O as in PoseEstimate, P the keyframe's camera.
struct Place {
  KnownPose pose;       ///< T_OP. Never changed: the map was built with it.
  KeyframeWindow view;  ///< That keyframe alone.
  cv::Mat small;        ///< Its left image at Levels::small.
  cv::Mat thumbnail;
  double depth = 0.0;       ///< [m] Median of its points.
  std::int64_t serial = 0;  ///< Keyframes made until then.
};

/// The places that were seen, few enough to be searched at once. Threading: one thread.
class PlaceMemory {
 public:
  struct Options {
    int most_places = 600;  ///< At 320 x 240 pixels each takes 0.25 MB. 0 = none is kept.
    int least_points = 30;  ///< With fewer it cannot be known again.
    /// A place is seen from a camera when so many of its points are: in the image,
    double least_overlap = 0.5;
    double least_depth_ratio = 0.6;  ///< about as far as they were,
    double most_depth_ratio = 1.7;
    double most_slant = 0.6;   ///< [rad] and from about the same side.
    double new_overlap = 0.7;  ///< A keyframe that sees less of every place becomes one.
  };
  PlaceMemory(const StereoGeometry& rig, const Options& options) : rig_(rig), options_(options) {}

  /// Keeps that keyframe unless a place is much the same; one that is known three times worse it takes the
  /// place of. When there are too many the farthest one goes.
  void Remember(const KnownPose& pose, const KeyframeWindow& window, const cv::Mat& small,
                std::int64_t serial);
  /// Of those which that camera should see the one whose pose is known best; null when there is none.
  /// @param before  Places from that keyframe on do not count.
  const Place* InView(const RigidTransform& T_OC, std::int64_t before) const;
  struct Reach {
    double way = 0.0;   ///< [m]
    double turn = 0.0;  ///< [rad]
  };
  /// Of the places within that reach of a camera whose pose is hardly known those that look most like what it
  /// sees, the most alike first.
  std::vector<const Place*> MostAlike(const cv::Mat& small, const RigidTransform& T_OC, const Reach& reach,
                                      std::size_t most) const;
  /// Share of a place's points that a camera there sees as the place did.
  double Overlap(const Place& place, const RigidTransform& T_OC) const;
  std::size_t size() const { return places_.size(); }

 private:
  StereoGeometry rig_;
  Options options_;
  std::vector<Place> places_;
};

/// A picture in 20 columns. @param image  CV_8UC1.
cv::Mat Thumbnail(const cv::Mat& image);
/// How alike two thumbnails of equal size are, whatever their brightness and contrast, and up to a turn by a
/// quarter of the field of view: the correlation of the middle of one with where it fits the other best.
/// @return  -1 to 1; 0 when that middle is blank.
double Likeness(const cv::Mat& thumbnail, const cv::Mat& other);

/// What a camera's pose becomes when it sees a place again: the mean of both, weighted by their covariances.
/// The pose's error since the place was kept is taken for what its covariance grew by; what did not grow is
/// not moved.
/// @param T_CP  As measured. @return  Nothing when the two contradict each other.
std::optional<KnownPose> Corrected(const KnownPose& camera, const KnownPose& place,
                                   const RigidTransform& T_CP, const Matrix6d& covariance_CP);

}  // namespace thalweg::visual_odometry
