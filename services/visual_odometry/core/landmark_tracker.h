#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "services/visual_odometry/core/keyframe_window.h"
#include "services/visual_odometry/core/pose_solver.h"
#include "services/visual_odometry/core/stereo_matcher.h"

namespace thalweg::visual_odometry {

/// Finds the landmarks of a window in a new frame, and from them the frame's pose.
///
/// First, each landmark is searched by SAD around its predicted position and aligned with subpixel accuracy.
/// Next, the pose is computed on which most of them agree. Finally, all landmarks are predicted from that
/// pose and aligned once more, in both images.
class LandmarkTracker {
 public:
  struct Options {
    double search_radius = 0.045;  ///< Share of the image's width, around the prediction.
    double wide_radius = 0.13;     ///< Likewise, for a second attempt.
    float least_correlation = 0.75F;
    PoseSolverOptions pose;
    StereoMatcherOptions stereo;
  };
  LandmarkTracker(const StereoGeometry& rig, const Levels& levels, const Options& options)
      : rig_(rig), levels_(levels), options_(options) {}

  struct Result {
    PoseSolution pose;                                ///< Pose of the frame relative to the newest keyframe.
    std::vector<KeyframeWindow::Sighting> sightings;  ///< The inliers, where they were seen, uncorrected.
    /// Number of landmarks that should be visible in the frame.
    int visible = 0;
    int with_right = 0;               ///< Number of sightings in both images.
    std::vector<double> row_offsets;  ///< [px] v_right - v_left of the points matched.
    double Share() const { return static_cast<double>(pose.inliers) / std::max(1, visible); }
    /// Median displacement of the sightings in the image since the newest keyframe.
    double parallax_px = 0.0;
  };
  /// Systematic errors of the camera, as far as they are known, that Track removes.
  void Correct(const DisparityBias& bias, double row_offset) {
    bias_ = bias;
    row_offset_ = row_offset;
  }
  /// Tracks the landmarks and solves for the pose; nothing if too few agree.
  /// @param use_right  Whether the right image can be used.
  std::optional<Result> Track(const KeyframeWindow& window, const Frame& frame,
                              const RigidTransform& T_CK_predicted, double sigma_px, bool wide,
                              bool use_right) const;

 private:
  struct Sight {
    std::size_t landmark;
    Eigen::Vector2f left;
    double correlation;
  };
  template <class Visit>
  void ForEachInView(const KeyframeWindow& window, const RigidTransform& T_CK, const Frame& frame,
                     Visit&& visit) const;
  std::vector<Sight> SearchAll(const KeyframeWindow& window, const Frame& frame, const RigidTransform& T_CK,
                               bool wide) const;
  std::vector<Sight> RefineAll(const KeyframeWindow& window, const Frame& frame,
                               const RigidTransform& T_CK) const;
  std::vector<PosePoint> PointsOf(const KeyframeWindow& window, const std::vector<Sight>& sights) const;

  StereoGeometry rig_;
  Levels levels_;
  Options options_;
  DisparityBias bias_ = DisparityBias::Zero();
  double row_offset_ = 0.0;
};

}  // namespace thalweg::visual_odometry
