#pragma once

#include <cstdint>
#include <optional>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/image_checks.h"
#include "services/visual_odometry/core/keyframe_window.h"
#include "services/visual_odometry/core/landmark_tracker.h"
#include "services/visual_odometry/core/place_finder.h"
#include "services/visual_odometry/core/place_memory.h"
#include "services/visual_odometry/core/reason.h"

namespace thalweg::visual_odometry {

enum class TrackingState : std::uint8_t {
  kTracking,  ///< The pose is valid within its covariance.
  kDegraded,  ///< There is a pose, but its quality is reduced: see the reason.
  kLost,      ///< The pose is the last good one, not the current one.
};

const char* NameOf(TrackingState state);  ///< tracking, degraded, lost

/// Frames: C is the left camera; O is the left camera's frame at the first image.
struct PoseEstimate {
  Time stamp;
  TrackingState state = TrackingState::kLost;
  Reason reason;  ///< None while tracking.
  RigidTransform T_OC = RigidTransform::Identity();
  /// Covariance of x = (v, w) [m, rad] in T_OC_true = T_OC * Moved(x, identity). It accumulates from the
  /// start.
  Matrix6d covariance = Matrix6d::Zero();
  /// Relative to the keyframe against which it was measured.
  RigidTransform T_KC = RigidTransform::Identity();
  Matrix6d covariance_KC = Matrix6d::Zero();         ///< Covariance of T_KC, i.e. of this measurement alone.
  Eigen::Vector3d v_OC_C = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d w_OC_C = Eigen::Vector3d::Zero();  ///< [rad/s]
  int inliers = 0;
  bool keyframe = false;    ///< Whether this frame became a keyframe.
  bool recognized = false;  ///< Whether a place seen long before was recognized and the pose fused with it.
  double sigma_px = 0.0;    ///< Standard deviation of the measurements, estimated from their residuals.
  CalibrationFinding calibration;  ///< What is believed about the stereo camera's calibration.
  /// Relative standard deviation of the scale of the motion because of what is left uncorrected of its error,
  /// with the points now in view.
  double scale_sigma = 0.0;
};

/// Estimates the robot's motion from its stereo images.
///
/// Follows the pipeline of Mei, Sibley, Cummins, Newman, Reid, RSLAM (IJCV 94, 2011): the rotation is
/// predicted from image brightness, known points are found by SAD around their prediction, features are
/// spread by a quadtree, and relative bundle adjustment refines the last keyframes. The cost per frame is
/// bounded, however long the path. A failure is part of the result: see PoseEstimate::state.
///
/// Threading: one thread.
class VisualOdometry {
 public:
  struct Options {
    int features = 250;  ///< Number of landmarks to track at a time.
    /// A new keyframe is made if a smaller share of the landmarks is found again.
    double keyframe_share = 0.7;
    double keyframe_parallax = 0.05;  ///< Likewise if they have moved by this share of the image's width.
    double keyframe_turn = 0.2;       ///< [rad] Likewise if the camera has rotated by this angle.
    int lost_inliers = 10;            ///< With fewer points found again, there is no pose.
    /// Likewise, as a share of the points that should be visible: so many may agree by chance.
    double lost_share = 0.2;
    /// With a smaller share of the points that should be visible, or residuals this many times as large as
    /// usual, other motion predictions and a wider search are tried.
    double weak_share = 0.6;
    double weak_sigma = 3.0;
    int degraded_inliers = 25;       ///< With fewer points, the pose is degraded.
    double degraded_share = 0.33;    ///< Likewise, as a share of the points that should be visible.
    double doubtful_sigma_px = 1.2;  ///< With larger residuals, the points do not fit one rigid motion.
    /// [m] Position uncertainty relative to the keyframe that is tolerated, plus
    double doubtful_sigma = 0.02;
    double doubtful_share = 0.05;  ///< this share of the distance from it.
    /// Factor on the solver's covariance, which is too small: landmarks are adjusted together with the poses,
    /// so that their errors are not independent as the solver assumes. Measured on rendered sequences.
    double covariance_factor = 1.6;
    /// Further factor on the variance from keyframe to keyframe, where points are fewest and the motion is
    /// largest. Measured likewise.
    double chain_factor = 2.0;
    /// In units of the usual time between frames: a longer gap means that frames were dropped.
    double longest_gap = 2.5;
    double longest_freeze = 1.0;  ///< [s] After this time with identical images there is no pose.
    /// [s] If tracking is lost for longer, the odometry restarts at the last good pose. Long enough for the
    /// robot to return to where its pose was known.
    double patience = 5.0;
    /// [m/s] Assumed growth of the robot's speed while lost, for the covariance.
    double lost_speed = 0.5;
    double lost_turn_rate = 0.5;  ///< [rad/s] Likewise for its rotation.
    /// Factor on the covariance of what a window says about the bias of disparities: its residuals are not
    /// independent. Measured on rendered and recorded sequences with bent right images.
    double bias_factor = 4.0;
    /// Share of the variance that comes from the bias which is added to each axis: how poses depend on it is
    /// known to first order only, and without what the adjustment changes later. Measured likewise.
    double bias_aside = 0.05;
    double renewed_bias_px =
        0.1;  ///< A larger change of the correction adjusts all steps of the window again.
    /// Relative standard deviation of the scale at which the pose is degraded if the calibration is off with
    /// this probability or a greater one,
    double doubtful_scale_off = 0.01;
    double doubtful_off = 0.1;
    double doubtful_scale = 0.04;  ///< and otherwise.
    int recognize_every = 5;       ///< Number of frames between two searches for a known place.
    double lost_reach = 1.0;  ///< [m] While lost, only places this close to the last good pose are searched.
    double lost_view = 1.0;   ///< [rad] Such a view is rotated from it by at most this angle.
    KeyframeWindow::Options window;
    StereoBiasMonitor::Options bias;
    PlaceMemory::Options places;
    PlaceFinder::Options finder;
    LandmarkTracker::Options tracker;
    ImageCheckOptions checks;
  };
  /// Throws std::invalid_argument naming what is wrong with the camera or an option.
  VisualOdometry(const StereoGeometry& rig, const Options& options);
  explicit VisualOdometry(const StereoGeometry& rig) : VisualOdometry(rig, Options()) {}

  /// Estimates the pose at a frame. Frames must come in order; one that is not later than the last is
  /// rejected. Throws std::invalid_argument if an image is not CV_8UC1 of the camera's size.
  PoseEstimate Track(const StereoImages& images);

  const PlaceMemory& places() const { return places_; }

 private:
  void CheckImages(const StereoImages& images) const;
  const cv::Mat& Small(const Frame& frame) const {
    return frame.left[static_cast<std::size_t>(levels_.small)];
  }
  PoseEstimate Follow(const StereoImages& images);
  PoseEstimate Refuse(const StereoImages& images) const;
  PoseEstimate Start(const Frame& frame, const Reason& why);
  PoseEstimate Lose(const Frame& frame, const Reason& reason, bool can_start);
  PoseEstimate Report(const Frame& frame, TrackingState state, const Reason& reason) const;
  std::optional<LandmarkTracker::Result> FindAgain(const Frame& frame, bool use_right) const;
  std::vector<RigidTransform> PredictMotion(const Frame& frame) const;
  bool TooFew(const std::optional<LandmarkTracker::Result>& result) const;
  bool NeedsKeyframe(const LandmarkTracker::Result& result) const;
  void MakeKeyframe(const Frame& frame, const LandmarkTracker::Result& result);
  std::vector<StereoPixel> FreshPoints(const Frame& frame, const std::vector<Eigen::Vector2f>& taken);
  Reason Doubt(const LandmarkTracker::Result& result, const ImageChecks::Findings& findings,
               bool dropped) const;
  KnownPose PoseOf(const PoseSolution& solution) const;
  /// Adjusts the window with what it says itself about the calibration.
  void AdjustWindow();
  /// Adds what is believed about the calibration to an estimate.
  void AddCalibration(PoseEstimate& estimate) const;
  double ScaleSigma(const Eigen::Vector2d& scale_by_bias) const;
  bool Recognize(const Frame& frame, bool use_right);
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
  StereoBiasMonitor bias_;
  DisparityBias bias_used_ = DisparityBias::Zero();  ///< By the window and the tracker.
  double row_used_ = 0.0;
  Eigen::Vector2d scale_by_bias_ = Eigen::Vector2d::Zero();  ///< As PoseSolution, at the last good frame.
  PlaceMemory places_;
  PlaceFinder finder_;

  RigidTransform T_OA_ = RigidTransform::Identity();  ///< A: the oldest keyframe of the window.
  /// Covariance of the newest keyframe, as PoseEstimate::covariance.
  Matrix6d covariance_OK_ = Matrix6d::Zero();
  BiasTrace bias_OK_;
  double sigma_px_;
  int landmarks_at_keyframe_ = 0;
  std::int64_t keyframes_made_ = 0;
  int frames_since_look_ = 0;  ///< Since the last search for a place.
  TrackingState last_state_ = TrackingState::kLost;
  bool astray_ = false;  ///< Restarted, and no known place recognized since.

  std::optional<Time> last_stamp_;
  double usual_period_ = 0.0;  ///< [s] 0 = unknown.
  int refused_ = 0;            ///< Number of consecutive frames rejected.

  // State at the last good frame.
  Time good_stamp_;
  cv::Mat good_small_;
  RigidTransform T_CK_ = RigidTransform::Identity();
  KnownPose good_{RigidTransform::Identity(), Matrix6d::Zero()};
  /// From the camera at the previous good frame to this one.
  RigidTransform T_step_ = RigidTransform::Identity();
  double step_time_ = 0.0;  ///< [s] Duration of T_step_; 0 = motion unknown.
};

}  // namespace thalweg::visual_odometry
