#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/image_checks.h"
#include "services/visual_odometry/core/keyframe_window.h"
#include "services/visual_odometry/core/landmark_tracker.h"
#include "services/visual_odometry/core/place_finder.h"
#include "services/visual_odometry/core/place_memory.h"

namespace thalweg::visual_odometry {

enum class TrackingState : std::uint8_t {
  kTracking,  ///< The pose is good, within its covariance.
  kDegraded,  ///< There is a pose, but something is wrong: see the reason.
  kLost,      ///< The pose is the last good one, not the present one.
};

const char* NameOf(TrackingState state);  ///< tracking, degraded, lost

/// Frames: C the left camera, O where the left camera stood at the first frame, with C's axes of then.
struct PoseEstimate {
  Time stamp;
  TrackingState state = TrackingState::kLost;
  std::string reason;  ///< Empty while tracking.
  RigidTransform T_OC = RigidTransform::Identity();
  /// Of x = (v, w) [m, rad] in T_OC_true = T_OC * Moved(x, identity): since the start, so it grows.
  Matrix6d covariance = Matrix6d::Zero();
  RigidTransform T_KC = RigidTransform::Identity();  ///< Against the keyframe that it was measured against.
  Matrix6d covariance_KC = Matrix6d::Zero();         ///< The same for T_KC: this measurement alone.
  Eigen::Vector3d v_OC_C = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d w_OC_C = Eigen::Vector3d::Zero();  ///< [rad/s]
  int inliers = 0;
  bool keyframe = false;    ///< This frame became one.
  bool recognised = false;  ///< It saw a place of long ago, and its pose is the mean of both.
  double sigma_px = 0.0;    ///< Of the measurements, as their residuals show it.
};

/// The robot's motion from its stereo images.
///
/// After the pipeline of Mei, Sibley, Cummins, Newman, Reid, RSLAM (IJCV 94, 2011): rotation predicted from
/// the images' brightness, known points found again by SAD around their prediction, features spread by a
/// quadtree, relative bundle adjustment over the last keyframes. Cost per frame is bounded, whatever came
/// before. Failures are part of the answer: see PoseEstimate::state. Threading: one thread.
class VisualOdometry {
 public:
  struct Options {
    int features = 250;               ///< Landmarks to be followed at a time.
    double keyframe_share = 0.7;      ///< A new keyframe when less than that of the landmarks is found again,
    double keyframe_parallax = 0.05;  ///< or they have moved by so much of the image's width,
    double keyframe_turn = 0.2;       ///< [rad] or the camera has turned by that.
    int lost_inliers = 10;            ///< Fewer points found again: no pose.
    double lost_share = 0.2;  ///< The same, of those that should be visible: so many may agree by chance.
    /// A smaller share of those that should be visible, or residuals so many times the usual: other
    /// predictions of the motion are tried, and a wider search.
    double weak_share = 0.6;
    double weak_sigma = 3.0;
    int degraded_inliers = 25;       ///< Fewer: a pose, but a doubtful one.
    double degraded_share = 0.33;    ///< The same, of those that should be visible.
    double doubtful_sigma_px = 1.2;  ///< Larger errors: the points do not move as one rigid world.
    double doubtful_sigma = 0.02;    ///< [m] Of the position against the keyframe, and
    double doubtful_share = 0.05;    ///< of the way since then.
    /// Landmarks are adjusted together with the poses, so their errors are not independent of each other, as
    /// the solver takes them to be: its covariance is that much too small. Measured on rendered sequences.
    double covariance_factor = 1.8;
    /// From keyframe to keyframe, with the fewest points and the largest motion, errors are that much larger
    /// again, in variance. Measured likewise.
    double chain_factor = 2.0;
    double longest_gap = 2.5;     ///< Usual times between frames: longer means that frames were dropped.
    double longest_freeze = 1.0;  ///< [s] Of the same image again and again, until there is no pose.
    /// [s] Lost for longer, the odometry begins anew at the last good pose. Time enough for the robot to go
    /// back to where it knew its place.
    double patience = 5.0;
    double lost_speed = 0.5;      ///< [m/s] That the robot may have gained meanwhile; for the covariance.
    double lost_turn_rate = 0.5;  ///< [rad/s]
    int recognise_every = 5;      ///< Frames between two looks for a place seen before.
    double lost_reach = 1.0;      ///< [m] Lost, places so near the last good pose are looked for,
    double lost_view = 1.0;       ///< [rad] turned from it by so much at most.
    KeyframeWindow::Options window;
    PlaceMemory::Options places;
    PlaceFinder::Options finder;
    LandmarkTracker::Options tracker;
    ImageCheckOptions checks;
  };
  /// Throws std::invalid_argument naming what is wrong with the camera or an option.
  VisualOdometry(const StereoGeometry& rig, const Options& options);
  explicit VisualOdometry(const StereoGeometry& rig) : VisualOdometry(rig, Options()) {}

  /// The pose at that frame. Frames come in order; one that is not later than the last is refused.
  /// Throws std::invalid_argument when an image is not CV_8UC1 of the camera's size.
  PoseEstimate Track(const StereoImages& images);

  const PlaceMemory& places() const { return places_; }

 private:
  void CheckImages(const StereoImages& images) const;
  const cv::Mat& Small(const Frame& frame) const {
    return frame.left[static_cast<std::size_t>(levels_.small)];
  }
  PoseEstimate Follow(const StereoImages& images);
  PoseEstimate Refuse(const StereoImages& images) const;
  PoseEstimate Start(const Frame& frame, const std::string& why);
  PoseEstimate Lose(const Frame& frame, const std::string& reason, bool can_start);
  PoseEstimate Report(const Frame& frame, TrackingState state, const std::string& reason) const;
  std::optional<LandmarkTracker::Result> FindAgain(const Frame& frame, bool use_right) const;
  std::vector<RigidTransform> PredictMotion(const Frame& frame) const;
  bool TooFew(const std::optional<LandmarkTracker::Result>& result) const;
  bool NeedsKeyframe(const LandmarkTracker::Result& result) const;
  void MakeKeyframe(const Frame& frame, const LandmarkTracker::Result& result);
  std::vector<StereoPixel> FreshPoints(const Frame& frame, const std::vector<Eigen::Vector2f>& taken) const;
  std::string Doubt(const LandmarkTracker::Result& result, const ImageChecks::Findings& findings,
                    bool dropped) const;
  KnownPose PoseOf(const RigidTransform& T_CK, const Matrix6d& covariance_CK) const;
  bool Recognise(const Frame& frame, bool use_right);
  PlaceFinder::Found Recover(const Frame& frame, const std::optional<LandmarkTracker::Result>& result,
                             bool use_right);
  void Unseen(double seconds, Matrix6d& covariance) const;
  RigidTransform T_OK() const { return T_OA_ * window_.NewestFromOldest().inverse(); }

  StereoGeometry rig_;
  Options options_;
  Levels levels_;
  KeyframeWindow window_;
  LandmarkTracker tracker_;
  ImageChecks checks_;
  PlaceMemory places_;
  PlaceFinder finder_;

  RigidTransform T_OA_ = RigidTransform::Identity();  ///< A: the oldest keyframe of the window.
  Matrix6d covariance_OK_ = Matrix6d::Zero();  ///< Of the newest keyframe, as PoseEstimate::covariance.
  double sigma_px_;
  int landmarks_at_keyframe_ = 0;
  std::int64_t keyframes_made_ = 0;
  int frames_since_look_ = 0;  ///< For a place.
  TrackingState last_state_ = TrackingState::kLost;
  bool astray_ = false;  ///< Begun anew, and no place known again since.

  std::optional<Time> last_stamp_;
  double usual_period_ = 0.0;  ///< [s] 0 = not known yet.
  int refused_ = 0;            ///< In a row.

  // The last good frame.
  Time good_stamp_;
  cv::Mat good_small_;
  RigidTransform T_CK_ = RigidTransform::Identity();
  KnownPose good_{RigidTransform::Identity(), Matrix6d::Zero()};
  RigidTransform T_step_ = RigidTransform::Identity();  ///< Of it from the one before, per second below.
  double step_time_ = 0.0;                              ///< [s] 0 = no motion known.
};

}  // namespace thalweg::visual_odometry
