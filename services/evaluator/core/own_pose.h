#pragma once

#include <optional>
#include <string>

#include "services/simulator/core/stereo_rig.h"
#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::evaluator {

/// Estimates the robot's pose from its own stereo images: renders them at the true pose and feeds them to the
/// visual odometry.
/// Threading: one thread.
class OwnPose {
 public:
  struct Options {
    simulator::StereoRigModel camera;
    visual_odometry::VisualOdometry::Options estimator;
  };
  /// Accuracy of the estimate against the truth.
  struct Figures {
    std::size_t frames = 0;
    std::size_t degraded = 0;     ///< Frames with a pose of doubtful quality.
    std::size_t lost = 0;         ///< Frames without a pose.
    std::size_t losses = 0;       ///< Number of times the pose was lost.
    double drift = 0.0;           ///< [m] Position error at the last frame that had a pose.
    double greatest_drift = 0.0;  ///< [m]
    bool operator==(const Figures&) const = default;
  };
  /// @param T_BC  Pose of the camera in the body. @param T_WB_start  Pose of the body at the first frame.
  OwnPose(const Options& options, const RigidTransform& T_BC, const RigidTransform& T_WB_start,
          std::uint32_t noise_seed);

  bool Due(Time now) const { return now + kEarly >= next_; }
  /// Processes the frame at `now`.
  /// @return T_WB as estimated; empty while the odometry is lost.
  std::optional<RigidTransform> Look(const simulator::World& world, const RigidTransform& T_WB_true,
                                     Time now);

  const Figures& figures() const { return figures_; }
  const visual_odometry::PoseEstimate& last() const { return last_; }

 private:
  static constexpr Duration kEarly = std::chrono::microseconds(100);  ///< Tolerance for rounded time steps.

  Duration period_;
  RigidTransform T_BC_;
  RigidTransform T_WO_;
  simulator::StereoRig rig_;
  visual_odometry::VisualOdometry odometry_;
  Time next_{};
  visual_odometry::PoseEstimate last_;
  Figures figures_;
};

}  // namespace thalweg::evaluator
