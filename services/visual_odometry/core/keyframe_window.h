#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/inverse_depth.h"
#include "services/visual_odometry/core/relative_adjustment.h"

namespace thalweg::visual_odometry {

/// A frame that is kept as a reference: landmarks are known in it, and later frames are measured against it.
struct Keyframe {
  std::int64_t id = 0;         ///< Consecutive.
  RigidTransform T_from_last;  ///< T_{k,k-1}: the pose of the previous keyframe in this one.
  Pyramid left;
  cv::Mat search;
};

/// A point of the world that is being tracked.
struct Landmark {
  struct Observation {
    std::int64_t keyframe = 0;
    StereoPixel pixel;  ///< As seen; the bias of disparities is still in it.
    bool has_right = false;
  };
  std::int64_t host = 0;  ///< Keyframe in whose frame q is expressed.
  InverseDepthPoint q;
  /// Observations in keyframes of the window, in order; the first is the host's.
  std::vector<Observation> seen;
  int misses = 0;  ///< Number of consecutive keyframes that missed it.

  InverseDepthPoint q_K = InverseDepthPoint::Zero();       ///< q in the newest keyframe.
  Eigen::Matrix3d q_covariance = Eigen::Matrix3d::Zero();  ///< Covariance of q_K for pixel errors of 1 px.
  InverseDepthPoint q_source =
      InverseDepthPoint::Zero();  ///< q in the keyframe that saw it last, from which its patch is cut.
};

/// The most recent keyframes and the landmarks observed in them. Poses are relative to each other, and a pose
/// that leaves the window is final.
///
/// Threading: one thread.
class KeyframeWindow {
 public:
  struct Options {
    int most_keyframes = 8;
    int settled_steps = 2;  ///< Number of oldest steps of a full window that the adjustment keeps fixed.
    /// Steps with fewer landmarks across them are kept fixed, too: the landmarks they were measured with are
    /// gone, and a few wrong ones would distort them.
    int least_across = 30;
    double point_sigma_px =
        0.15;                 ///< [px] Matching error that a landmark has in all frames, see EvidenceOfBias.
    double outlier_px = 3.0;  ///< An observation with a larger error after the adjustment is wrong.
    int most_misses = 1;      ///< Number of consecutive keyframes that may miss a landmark.
    AdjustmentOptions adjustment;
  };
  KeyframeWindow(const StereoGeometry& rig, const Options& options) : rig_(rig), options_(options) {}

  bool empty() const { return keyframes_.empty(); }
  const Keyframe& newest() const { return keyframes_.back(); }
  const Keyframe& at(std::int64_t id) const {
    return keyframes_[static_cast<std::size_t>(id - keyframes_.front().id)];
  }
  const std::vector<Landmark>& landmarks() const { return landmarks_; }
  int keyframes() const { return static_cast<int>(keyframes_.size()); }

  void Clear();
  struct Sighting {
    std::size_t landmark = 0;
    StereoPixel pixel;
    bool has_right = false;
  };
  /// Appends a keyframe.
  /// @param T_from_last  Pose of the newest keyframe in the new one; ignored for the first.
  /// @param sightings  Observations of landmarks(); landmarks without one count as missed.
  /// @param fresh  New points of the frame, each with a right pixel.
  /// @return T_old_new, the pose of the new oldest keyframe in the old oldest one; identity if none was
  ///   dropped.
  RigidTransform Append(const Frame& frame, const RigidTransform& T_from_last,
                        const std::vector<Sighting>& sightings, const std::vector<StereoPixel>& fresh);
  /// Assumes another systematic error of the disparities: moves the points to the depths that follow.
  void SetBias(const DisparityBias& bias);
  enum class Hold : std::uint8_t { kSettled, kNone };
  /// Adjusts steps and landmarks to all observations.
  /// @param hold  kNone: all steps, since their scale was wrong.
  void AdjustAll(Hold hold = Hold::kSettled);
  /// What all observations say about the bias, in addition to the one assumed; nothing if too few.
  std::optional<BiasEvidence> EvidenceOfBias() const;
  /// A window of the newest keyframe alone, with the landmarks observed in it. Shares its images.
  KeyframeWindow Newest() const;
  /// Transform from the oldest keyframe to the newest.
  RigidTransform NewestFromOldest() const;

 private:
  int IndexOf(std::int64_t id) const { return static_cast<int>(id - keyframes_.front().id); }
  std::vector<RigidTransform> Steps() const;
  void DropOldest();
  /// Landmarks observed at least twice, and their indices in landmarks_.
  std::pair<AdjustmentWindow, std::vector<std::size_t>> Observed() const;
  std::vector<std::uint8_t> HeldSteps() const;
  void Refresh();

  StereoGeometry rig_;
  Options options_;
  DisparityBias bias_ = DisparityBias::Zero();
  std::deque<Keyframe> keyframes_;
  std::vector<Landmark> landmarks_;
  std::int64_t next_id_ = 0;
};

}  // namespace thalweg::visual_odometry
