#include "services/visual_odometry/adapter/text.h"

#include <fmt/format.h>

#include <cmath>

namespace thalweg::visual_odometry {
namespace {

std::string EyeText(Eye eye) {
  switch (eye) {
    case Eye::kLeft:
      return "left image";
    case Eye::kRight:
      return "right image";
    case Eye::kBoth:
      break;
  }
  return "both images";
}

}  // namespace

std::string Fixed(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

std::string ReasonText(const Reason& reason) {
  using Kind = Reason::Kind;
  const double amount = reason.amount;
  switch (reason.kind) {
    case Kind::kNone:
      break;
    case Kind::kDark:
      return EyeText(reason.eye) + " is dark: mean " + Fixed(amount, 1);
    case Kind::kBlank:
      return EyeText(reason.eye) + " shows nothing (covered?): contrast " + Fixed(amount, 1);
    case Kind::kFrozen:
      return EyeText(reason.eye) + (reason.eye == Eye::kBoth ? " are" : " is") +
             " unchanged since the previous frame";
    case Kind::kBlurred:
      return "image is blurred: sharpness " + Fixed(100.0 * amount, 1) + " % of its usual value";
    case Kind::kTimeRunsBackwards:
      return "time runs backwards by " + Fixed(amount, 3) + " s";
    case Kind::kFramesDropped:
      return "frames were dropped";
    case Kind::kPlacesLookAlike:
      return "several known places look alike";
    case Kind::kTooFewPoints:
      return "too few points tracked: " + Fixed(amount, 0);
    case Kind::kFewPoints:
      return "few points tracked: " + Fixed(amount, 0);
    case Kind::kFewOfVisiblePoints:
      return "only " + Fixed(100.0 * amount, 0) + " % of the points tracked";
    case Kind::kTooFewToStart:
      return "too few points to start with: " + Fixed(amount, 0);
    case Kind::kFewToStart:
      return "few points to start with: " + Fixed(amount, 0);
    case Kind::kNotRigid:
      return "points do not fit one rigid motion: residual of " + Fixed(amount, 1) + " px";
    case Kind::kPositionUncertain:
      return "position uncertain by " + Fixed(1000.0 * amount, 0) + " mm since the last keyframe";
    case Kind::kCalibrationOff:
      return "the calibration seems off by about " + Fixed(reason.offset_px, 1) +
             " px: distances uncertain by " + Fixed(100.0 * amount, 1) + " %";
    case Kind::kSmallDisparities:
      return "small disparities: distances uncertain by " + Fixed(100.0 * amount, 1) + " %";
    case Kind::kRestarted:
      return "restarted after " + Fixed(amount, 1) + " s without a pose";
    case Kind::kRelocalized:
      return "relocalized at a known place";
    case Kind::kNotRelocalized:
      return "not relocalized since the restart";
  }
  return {};
}

}  // namespace thalweg::visual_odometry
