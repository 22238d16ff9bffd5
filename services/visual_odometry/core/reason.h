#pragma once

#include <cstdint>

namespace thalweg::visual_odometry {

enum class Eye : std::uint8_t { kLeft, kRight, kBoth };

/// Why the quality of a pose is reduced, or why there is none.
struct Reason {
  enum class Kind : std::uint8_t {
    kNone,
    kDark,               ///< The eye's image; amount: mean gray value.
    kBlank,              ///< The eye's image shows nothing; amount: standard deviation of its gray values.
    kFrozen,             ///< The eye's image equals the previous one to the last bit.
    kBlurred,            ///< amount: sharpness as a share of the usual one.
    kTimeRunsBackwards,  ///< amount: by how much [s].
    kFramesDropped,
    kPlacesLookAlike,     ///< Several known places would explain the image.
    kTooFewPoints,        ///< amount: number of points found again; with so few there is no pose.
    kFewPoints,           ///< amount: number of points found again.
    kFewOfVisiblePoints,  ///< amount: share of the points that should be visible that was found again.
    kTooFewToStart,       ///< amount: number of points seen; with so few there is no pose.
    kFewToStart,          ///< amount: number of points seen.
    kNotRigid,            ///< The points do not move as one; amount: standard deviation of residuals [px].
    kPositionUncertain,   ///< amount: standard deviation [m] since the last keyframe.
    kCalibrationOff,      ///< amount: relative standard deviation of the scale.
    kSmallDisparities,    ///< amount: as above.
    kRestarted,           ///< At the last good pose; amount: time without a pose [s].
    kRelocalized,         ///< At a known place: the pose leaps.
    kNotRelocalized,      ///< Not yet since the restart.
  };
  Kind kind = Kind::kNone;
  double amount = 0.0;     ///< See Kind.
  Eye eye = Eye::kLeft;    ///< For kDark, kBlank and kFrozen.
  double offset_px = 0.0;  ///< For kCalibrationOff: about how much the calibration is off.

  explicit operator bool() const { return kind != Kind::kNone; }
};

}  // namespace thalweg::visual_odometry
