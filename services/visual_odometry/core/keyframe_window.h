#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "services/visual_odometry/core/frame.h"
#include "services/visual_odometry/core/inverse_depth.h"
#include "services/visual_odometry/core/relative_adjustment.h"

namespace thalweg::visual_odometry {

/// A frame that is kept: points are known in it and other frames are measured against it.
struct Keyframe {
  std::int64_t id = 0;         ///< Counts up by one.
  RigidTransform T_from_last;  ///< T of this keyframe from the one before, T_{k,k-1}.
  Pyramid left;
  cv::Mat search;
};

/// A point of the world that is being followed.
struct Landmark {
  struct Observation {
    std::int64_t keyframe = 0;
    StereoPixel pixel;
    bool has_right = false;
  };
  std::int64_t host = 0;  ///< Keyframe whose frame q is in.
  InverseDepthPoint q;
  std::vector<Observation> seen;  ///< In keyframes of the window, in order; the first one is the host's.
  int misses = 0;                 ///< Keyframes in a row without it.

  InverseDepthPoint q_K = InverseDepthPoint::Zero();       ///< In the newest keyframe.
  Eigen::Matrix3d q_covariance = Eigen::Matrix3d::Zero();  ///< Of q_K, for pixel errors of 1 px.
  InverseDepthPoint q_source =
      InverseDepthPoint::Zero();  ///< In the keyframe that saw it last, where its picture is cut from.
};

/// The last keyframes and the landmarks seen in them. Poses are relative to each other; what leaves the
/// window is settled. Threading: one thread.
class KeyframeWindow {
 public:
  struct Options {
    int most_keyframes = 8;
    int settled_steps = 2;  ///< The oldest steps of a full window are held in the adjustment.
    /// Steps across which fewer landmarks are left are held, too: the landmarks that they were measured with
    /// are gone, and a few wrong ones would bend them.
    int least_across = 30;
    double outlier_px = 3.0;  ///< Left after adjustment: the observation was wrong.
    int most_misses = 1;      ///< Keyframes in a row that may miss a landmark.
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
  /// Appends a keyframe. @param T_from_last  Against the newest one; ignored for the first.
  /// @param sightings  Of landmarks(); those without one are missed.
  /// @param fresh  New points of that frame, each with a right pixel.
  /// @return  T_first_last by which the oldest keyframe moved on: pose of the new oldest keyframe in the old
  /// oldest one.
  RigidTransform Append(const Frame& frame, const RigidTransform& T_from_last,
                        const std::vector<Sighting>& sightings, const std::vector<StereoPixel>& fresh);
  /// Adjusts steps and landmarks to all that was seen.
  void AdjustAll();
  /// The newest keyframe alone, with the landmarks seen in it. Shares their pictures.
  KeyframeWindow Newest() const;
  /// T of the newest keyframe from the oldest.
  RigidTransform NewestFromOldest() const;

 private:
  int IndexOf(std::int64_t id) const { return static_cast<int>(id - keyframes_.front().id); }
  std::vector<RigidTransform> Steps() const;
  void DropOldest();
  std::vector<std::uint8_t> HeldSteps() const;
  void Refresh();

  StereoGeometry rig_;
  Options options_;
  std::deque<Keyframe> keyframes_;
  std::vector<Landmark> landmarks_;
  std::int64_t next_id_ = 0;
};

}  // namespace thalweg::visual_odometry
