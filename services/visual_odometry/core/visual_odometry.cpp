#include "services/visual_odometry/core/visual_odometry.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "common/base/size_text.h"
#include "services/visual_odometry/core/corners.h"
#include "services/visual_odometry/core/rotation_prediction.h"

namespace thalweg::visual_odometry {
namespace {

constexpr double kFirstSigma = 0.3;  // [px] until residuals are available
constexpr double kSigmaHabit = 0.1;  // weight of a new frame in the running mean
constexpr double kPeriodHabit = 0.1;
constexpr int kRefusedUntilNewTime = 3;
constexpr double kAnyTurn = 1.8;  // [rad] sigma of a completely unknown angle: pi / sqrt(3)

Reason ReasonOf(Reason::Kind kind, double amount) {
  return {.kind = kind, .amount = amount};
}

void CheckOptions(const StereoGeometry& rig, const VisualOdometry::Options& options) {
  const auto require = [](bool holds, const char* text) {
    if (!holds) throw std::invalid_argument(std::string("visual odometry: ") + text);
  };
  require(rig.camera.width_px >= 64 && rig.camera.height_px >= 48,
          "the images must be at least 64 x 48 pixels");
  require(rig.camera.fx > 0.0 && rig.camera.fy > 0.0, "focal lengths must be > 0");
  require(rig.baseline > 0.0, "the baseline must be > 0");
  require(options.features >= 20, "features must be >= 20");
  require(options.lost_inliers >= 6, "lost_inliers must be >= 6: a pose has six degrees of freedom");
  require(options.covariance_factor > 0.0, "covariance_factor must be > 0");
  require(options.chain_factor >= 1.0, "chain_factor must be >= 1");
  require(options.bias_factor > 0.0, "bias_factor must be > 0");
  require(options.bias_aside >= 0.0, "bias_aside must be >= 0");
  require(options.recognize_every >= 1, "recognize_every must be >= 1");
  require(options.finder.least_inliers >= options.lost_inliers,
          "finder.least_inliers must be >= lost_inliers");
  require(options.finder.least_share >= options.lost_share && options.finder.least_share <= 1.0,
          "finder.least_share must be lost_share to 1");
  require(options.places.most_places >= 0, "places.most_places must be >= 0");
  require(options.window.most_keyframes >= 2, "window.most_keyframes must be >= 2");
  require(options.window.settled_steps >= 0, "window.settled_steps must be >= 0");
}

}  // namespace

const char* NameOf(TrackingState state) {
  switch (state) {
    case TrackingState::kTracking:
      return "tracking";
    case TrackingState::kDegraded:
      return "degraded";
    case TrackingState::kLost:
      break;
  }
  return "lost";
}

VisualOdometry::VisualOdometry(const StereoGeometry& rig, const Options& options)
    : rig_(rig),
      options_(options),
      levels_(Levels::For(rig.camera.width_px)),
      window_(rig, options.window),
      tracker_(rig, levels_, options.tracker),
      checks_(options.checks),
      bias_(options.bias),
      places_({rig.camera, rig.baseline}, options.places),
      finder_(tracker_, rig.camera, levels_, options.finder),
      sigma_px_(kFirstSigma) {
  CheckOptions(rig, options);
}

void VisualOdometry::CheckImages(const StereoImages& images) const {
  const cv::Size size(rig_.camera.width_px, rig_.camera.height_px);
  for (const cv::Mat* image : {&images.left, &images.right}) {
    if (image->type() == CV_8UC1 && image->size() == size) continue;
    throw std::invalid_argument(std::string(image == &images.left ? "left" : "right") + " image is " +
                                SizeText(image->cols, image->rows) + " of " +
                                std::to_string(image->channels()) + " channels, must be " +
                                SizeText(size.width, size.height) + " gray");
  }
}

PoseEstimate VisualOdometry::Track(const StereoImages& images) {
  CheckImages(images);
  PoseEstimate estimate = Follow(images);
  last_state_ = estimate.state;
  return estimate;
}

PoseEstimate VisualOdometry::Follow(const StereoImages& images) {
  bool clock_set = false;
  if (last_stamp_ && images.stamp <= *last_stamp_) {
    if (++refused_ < kRefusedUntilNewTime) return Refuse(images);
    // The clock was set back, so tracking continues with the new time. How much time has really passed is
    // unknown.
    clock_set = true;
    step_time_ = 0.0;
    usual_period_ = 0.0;
    good_stamp_ = images.stamp - FromSeconds(options_.patience);
    last_stamp_.reset();
  }
  refused_ = 0;
  const Frame frame = MakeFrame(images, levels_);
  const ImageChecks::Findings findings = checks_.Look(images, frame, levels_);
  const double passed = last_stamp_ ? Seconds(frame.stamp - *last_stamp_) : 0.0;
  const bool dropped = usual_period_ > 0.0 && passed > options_.longest_gap * usual_period_;
  if (last_stamp_ && !dropped) {
    usual_period_ =
        usual_period_ > 0.0 ? (1.0 - kPeriodHabit) * usual_period_ + kPeriodHabit * passed : passed;
  }
  last_stamp_ = frame.stamp;

  if (findings.unusable) return Lose(frame, findings.unusable, false);
  const bool has_right = !findings.right_blind;
  if (window_.empty()) {
    return has_right ? Start(frame, {}) : Lose(frame, findings.right_blind, false);
  }
  if (findings.frozen) {
    const bool long_ago = Seconds(frame.stamp - good_stamp_) > options_.longest_freeze;
    if (long_ago || last_state_ == TrackingState::kLost) return Lose(frame, findings.frozen, false);
    return Report(frame, TrackingState::kDegraded, findings.frozen);
  }

  auto result = FindAgain(frame, has_right);
  const bool gap =
      clock_set || last_state_ == TrackingState::kLost ||
      (usual_period_ > 0.0 && Seconds(frame.stamp - good_stamp_) > options_.longest_gap * usual_period_);
  bool went_astray = false;
  if (TooFew(result) || gap) {
    PlaceFinder::Found found = Recover(frame, result, has_right);
    if (found.disputed) return Lose(frame, {.kind = Reason::Kind::kPlacesLookAlike}, has_right);
    went_astray = found.seen.has_value();
    if (found.seen) result = std::move(found.seen->result);
  }
  if (TooFew(result)) {
    return Lose(frame, ReasonOf(Reason::Kind::kTooFewPoints, result ? result->pose.inliers : 0), has_right);
  }

  ++frames_since_look_;
  result->pose.covariance *= options_.covariance_factor;
  Reason doubt = Doubt(*result, findings, dropped);
  if (!doubt && went_astray) doubt.kind = Reason::Kind::kRelocalized;
  if (!doubt && astray_) doubt.kind = Reason::Kind::kNotRelocalized;
  const KnownPose pose = PoseOf(result->pose);
  scale_by_bias_ = result->pose.scale_by_bias;
  bias_.AddRows(result->row_offsets);
  const double since_good = Seconds(frame.stamp - good_stamp_);
  T_step_ = pose.T_OC.inverse() * good_.T_OC;
  step_time_ = went_astray ? 0.0 : since_good;  // a relocalization is not a motion
  good_ = pose;
  good_stamp_ = frame.stamp;
  Small(frame).copyTo(good_small_);
  T_CK_ = result->pose.T_CK;
  if (!doubt) sigma_px_ += kSigmaHabit * (result->pose.sigma_px - sigma_px_);

  PoseEstimate estimate = Report(frame, doubt ? TrackingState::kDegraded : TrackingState::kTracking, doubt);
  estimate.inliers = result->pose.inliers;
  estimate.sigma_px = result->pose.sigma_px;
  estimate.T_KC = T_CK_.inverse();
  estimate.covariance_KC =
      result->pose.covariance + result->pose.by_bias * bias_.ErrorMoment() * result->pose.by_bias.transpose();
  estimate.recognized = went_astray;
  if (has_right && NeedsKeyframe(*result)) {
    MakeKeyframe(frame, *result);
    estimate.recognized |= Recognize(frame, has_right);
    if (astray_ && estimate.recognized) {
      astray_ = false;
      estimate.reason = {.kind = Reason::Kind::kRelocalized};
    }
    if (!doubt) places_.Remember(good_, window_, good_small_, keyframes_made_);
    estimate.keyframe = true;
    estimate.T_OC = good_.T_OC;
    AddCalibration(estimate);
  }
  return estimate;
}

Reason VisualOdometry::Doubt(const LandmarkTracker::Result& result, const ImageChecks::Findings& findings,
                             bool dropped) const {
  using Kind = Reason::Kind;
  const PoseSolution& pose = result.pose;
  if (findings.right_blind) return findings.right_blind;
  if (findings.blurred) return findings.blurred;
  if (dropped) return {.kind = Kind::kFramesDropped};
  if (pose.inliers < options_.degraded_inliers) return ReasonOf(Kind::kFewPoints, pose.inliers);
  if (pose.sigma_px > options_.doubtful_sigma_px) return ReasonOf(Kind::kNotRigid, pose.sigma_px);
  const double sigma = PositionSigma(pose.covariance);
  const double distance = pose.T_CK.translation().norm();
  if (sigma > options_.doubtful_sigma + options_.doubtful_share * distance)
    return ReasonOf(Kind::kPositionUncertain, sigma);
  const double scale = ScaleSigma(pose.scale_by_bias);
  const CalibrationFinding calibration = bias_.Finding(rig_.camera);
  if (calibration.off_probability > options_.doubtful_off && scale > options_.doubtful_scale_off)
    return {.kind = Kind::kCalibrationOff, .amount = scale, .offset_px = calibration.offset_px};
  if (scale > options_.doubtful_scale) return ReasonOf(Kind::kSmallDisparities, scale);
  if (pose.inliers < options_.degraded_share * result.visible)
    return ReasonOf(Kind::kFewOfVisiblePoints, result.Share());
  return {};
}

KnownPose VisualOdometry::PoseOf(const PoseSolution& solution) const {
  // T_OK (1 + y) T_KC (1 - x) = T_OC (1 + Ad(T_CK) y - x), with x the error of T_CK.
  const Matrix6d adjoint = Adjoint(solution.T_CK);
  return {T_OK() * solution.T_CK.inverse(),
          adjoint * covariance_OK_ * adjoint.transpose() + solution.covariance,
          {adjoint * bias_OK_.by_bias - solution.by_bias,
           adjoint * bias_OK_.removed - solution.by_bias * bias_used_}};
}

void VisualOdometry::AddCalibration(PoseEstimate& estimate) const {
  const Matrix6d bias = good_.bias.Moment(bias_);
  estimate.covariance = good_.covariance + bias;
  estimate.covariance.diagonal().head<3>().array() +=
      options_.bias_aside * bias.topLeftCorner<3, 3>().trace();
  estimate.covariance.diagonal().tail<3>().array() +=
      options_.bias_aside * bias.bottomRightCorner<3, 3>().trace();
  estimate.calibration = bias_.Finding(rig_.camera);
  estimate.scale_sigma = ScaleSigma(scale_by_bias_);
}

double VisualOdometry::ScaleSigma(const Eigen::Vector2d& scale_by_bias) const {
  return std::sqrt(scale_by_bias.dot(bias_.ErrorMoment() * scale_by_bias));
}

std::optional<LandmarkTracker::Result> VisualOdometry::FindAgain(const Frame& frame, bool use_right) const {
  const std::vector<RigidTransform> predictions = PredictMotion(frame);
  std::optional<LandmarkTracker::Result> best;
  const auto weak = [&] {
    return !best || best->pose.inliers < options_.weak_share * best->visible ||
           best->pose.sigma_px > options_.weak_sigma * sigma_px_;
  };
  const auto take = [&](std::optional<LandmarkTracker::Result> other) {
    if (other && (!best || other->pose.inliers > best->pose.inliers)) best = std::move(other);
  };
  for (const RigidTransform& T_CK : predictions) {
    if (weak()) take(tracker_.Track(window_, frame, T_CK, sigma_px_, false, use_right));
  }
  if (weak()) take(tracker_.Track(window_, frame, predictions.front(), sigma_px_, true, use_right));
  return best;
}

std::vector<RigidTransform> VisualOdometry::PredictMotion(const Frame& frame) const {
  // The camera continues its motion, or stops, or rotates as the whole image does. The guess that explains
  // the image best comes first.
  const double passed = Seconds(frame.stamp - good_stamp_);
  const double share = step_time_ > 0.0 && passed < 1.0 ? passed / step_time_ : 0.0;
  const Eigen::Matrix3d R_steady = RotationFromVector(share * VectorFromRotation(T_step_.linear()));
  const Eigen::Matrix3d R = BestRotation(good_small_, Small(frame), ScaledDown(rig_.camera, levels_.small),
                                         {R_steady, Eigen::Matrix3d::Identity()});
  const Eigen::Vector3d step = share * T_step_.translation();
  std::vector<RigidTransform> predictions;
  for (const RigidTransform& T_CK :
       {MakeTransform(R, step) * T_CK_, MakeTransform(R_steady, step) * T_CK_, T_CK_}) {
    const auto same = [&](const RigidTransform& other) { return other.matrix() == T_CK.matrix(); };
    if (std::ranges::none_of(predictions, same)) predictions.push_back(T_CK);
  }
  return predictions;
}

bool VisualOdometry::TooFew(const std::optional<LandmarkTracker::Result>& result) const {
  return !result || result->pose.inliers < options_.lost_inliers ||
         result->pose.inliers < options_.lost_share * result->visible;
}

bool VisualOdometry::NeedsKeyframe(const LandmarkTracker::Result& result) const {
  if (static_cast<double>(result.pose.inliers) < options_.keyframe_share * landmarks_at_keyframe_)
    return true;
  if (result.parallax_px > options_.keyframe_parallax * rig_.camera.width_px) return true;
  return AngleBetween(result.pose.T_CK, RigidTransform::Identity()) > options_.keyframe_turn;
}

std::vector<StereoPixel> VisualOdometry::FreshPoints(const Frame& frame,
                                                     const std::vector<Eigen::Vector2f>& taken) {
  const std::vector<Eigen::Vector2f> corners = FindCorners(frame.left[0], taken, options_.features);
  std::vector<StereoPixel> fresh;
  const auto match = [&] {
    StereoMatcher matcher(frame, levels_, options_.tracker.stereo, row_used_);
    fresh.clear();
    for (const Eigen::Vector2f& left : corners) {
      const auto right = matcher.Search(left);
      if (!right) continue;
      fresh.emplace_back(static_cast<double>(left.x()), static_cast<double>(left.y()), *right);
    }
    bias_.AddRows(matcher.row_offsets());
  };
  match();
  // Rows that turn out to be far off had most points refused.
  if (std::abs(bias_.row_correction() - row_used_) > options_.renewed_bias_px) {
    row_used_ = bias_.row_correction();
    match();
  }
  tracker_.Correct(bias_used_, row_used_);
  return fresh;
}

void VisualOdometry::AdjustWindow() {
  window_.AdjustAll();
  if (const auto evidence = window_.EvidenceOfBias()) {
    // Each observation speaks in as many windows as there are steps.
    const double share = 1.0 / (options_.bias_factor * (window_.keyframes() - 1));
    bias_.AddDisparities(bias_used_ + evidence->residual, share * evidence->information,
                         share * evidence->with_known_motion);
  }
  const bool renewed = (bias_.correction() - bias_used_).norm() > options_.renewed_bias_px;
  bias_used_ = bias_.correction();
  window_.SetBias(bias_used_);
  if (renewed) window_.AdjustAll(KeyframeWindow::Hold::kNone);
  tracker_.Correct(bias_used_, row_used_);
}

void VisualOdometry::MakeKeyframe(const Frame& frame, const LandmarkTracker::Result& result) {
  std::vector<Eigen::Vector2f> taken;
  for (const KeyframeWindow::Sighting& sighting : result.sightings) {
    taken.push_back(sighting.pixel.head<2>().cast<float>());
  }
  T_OA_ = T_OA_ * window_.Append(frame, result.pose.T_CK, result.sightings, FreshPoints(frame, taken));
  AdjustWindow();
  bias_OK_ = good_.bias;
  covariance_OK_ = good_.covariance + (options_.chain_factor - 1.0) * result.pose.covariance;
  landmarks_at_keyframe_ = static_cast<int>(window_.landmarks().size());
  ++keyframes_made_;
  T_CK_ = RigidTransform::Identity();
  good_ = {T_OK(), covariance_OK_, bias_OK_};
}

bool VisualOdometry::Recognize(const Frame& frame, bool use_right) {
  if (frames_since_look_ < options_.recognize_every) return false;
  const PlaceFinder::Sight sight{frame, use_right, sigma_px_, good_.T_OC};
  std::optional<SeenPlace> found;
  if (astray_) {
    // Its pose is too uncertain to predict which places are in view.
    frames_since_look_ = 0;
    const PlaceMemory::Reach reach{options_.lost_reach + 2.0 * PositionSigma(good_.covariance),
                                   options_.lost_view + 2.0 * RotationSigma(good_.covariance)};
    found = finder_.Search(places_, reach, sight, nullptr).seen;
  } else if (const Place* const place =
                 places_.InView(good_.T_OC, keyframes_made_ - options_.window.most_keyframes)) {
    frames_since_look_ = 0;
    found = finder_.Look(*place, sight);
  }
  if (!found) return false;
  const PoseSolution& seen = found->result.pose;
  const auto corrected = Corrected(good_, found->place->pose, seen.T_CK,
                                   options_.covariance_factor * options_.chain_factor * seen.covariance,
                                   {seen.by_bias, seen.by_bias * bias_used_}, bias_);
  if (!corrected) return false;
  // The newest keyframe is this frame; the window moves as a whole.
  T_OA_ = corrected->T_OC * window_.NewestFromOldest();
  covariance_OK_ = corrected->covariance;
  bias_OK_ = corrected->bias;
  good_ = *corrected;
  return true;
}

PlaceFinder::Found VisualOdometry::Recover(const Frame& frame,
                                           const std::optional<LandmarkTracker::Result>& result,
                                           bool use_right) {
  const double unseen = Seconds(frame.stamp - good_stamp_);
  PlaceMemory::Reach reach{options_.lost_reach + options_.lost_speed * unseen,
                           options_.lost_view + options_.lost_turn_rate * unseen};
  std::optional<PlaceFinder::Belief> own;
  if (!TooFew(result)) {
    // The last keyframe itself is visible, so the robot cannot have moved farther than its speed allows.
    Matrix6d grown = Matrix6d::Zero();
    Unseen(unseen, grown);
    reach = {std::sqrt(grown(0, 0)), std::sqrt(grown(3, 3))};
    own = {T_OK() * result->pose.T_CK.inverse(), covariance_OK_, result->Share()};
  }
  PlaceFinder::Found found =
      finder_.Search(places_, reach, {frame, use_right, sigma_px_, good_.T_OC}, own ? &*own : nullptr);
  if (!found.seen) return found;
  const Place& place = *found.seen->place;
  window_ = place.view;
  T_OA_ = place.pose.T_OC;
  covariance_OK_ = place.pose.covariance;
  bias_OK_ = place.pose.bias;
  astray_ = false;
  landmarks_at_keyframe_ = static_cast<int>(window_.landmarks().size());
  return found;
}

PoseEstimate VisualOdometry::Start(const Frame& frame, const Reason& why) {
  const std::vector<StereoPixel> fresh = FreshPoints(frame, {});
  const int seen = static_cast<int>(fresh.size());
  if (seen < options_.lost_inliers)
    return Report(frame, TrackingState::kLost, ReasonOf(Reason::Kind::kTooFewToStart, seen));
  window_.Clear();
  window_.SetBias(bias_used_);
  window_.Append(frame, RigidTransform::Identity(), {}, fresh);
  T_OA_ = good_.T_OC;
  T_CK_ = RigidTransform::Identity();
  covariance_OK_ = good_.covariance;
  bias_OK_ = good_.bias;
  landmarks_at_keyframe_ = static_cast<int>(window_.landmarks().size());
  step_time_ = 0.0;
  good_stamp_ = frame.stamp;
  Small(frame).copyTo(good_small_);
  const Reason reason = seen < options_.degraded_inliers ? ReasonOf(Reason::Kind::kFewToStart, seen) : why;
  PoseEstimate estimate = Report(frame, reason ? TrackingState::kDegraded : TrackingState::kTracking, reason);
  estimate.inliers = seen;
  estimate.keyframe = true;
  estimate.sigma_px = sigma_px_;
  return estimate;
}

PoseEstimate VisualOdometry::Lose(const Frame& frame, const Reason& reason, bool can_start) {
  const double unseen = Seconds(frame.stamp - good_stamp_);
  if (window_.empty() || !can_start || unseen < options_.patience) {
    return Report(frame, TrackingState::kLost, reason);
  }
  // No known place was recognized: continue from the last good pose, with the uncertainty that has
  // accumulated.
  const KnownPose before = good_;
  Unseen(unseen, good_.covariance);
  const PoseEstimate estimate = Start(frame, ReasonOf(Reason::Kind::kRestarted, unseen));
  if (estimate.state == TrackingState::kLost) {
    good_ = before;
  } else {
    astray_ = true;
  }
  return estimate;
}

PoseEstimate VisualOdometry::Refuse(const StereoImages& images) const {
  PoseEstimate estimate;
  estimate.stamp = images.stamp;
  estimate.state = last_state_ == TrackingState::kLost ? TrackingState::kLost : TrackingState::kDegraded;
  estimate.reason = ReasonOf(Reason::Kind::kTimeRunsBackwards, Seconds(*last_stamp_ - images.stamp));
  estimate.T_OC = good_.T_OC;
  AddCalibration(estimate);
  Unseen(std::max(0.0, Seconds(*last_stamp_ - good_stamp_)), estimate.covariance);
  return estimate;
}

PoseEstimate VisualOdometry::Report(const Frame& frame, TrackingState state, const Reason& reason) const {
  PoseEstimate estimate;
  estimate.stamp = frame.stamp;
  estimate.state = state;
  estimate.reason = reason;
  estimate.T_OC = good_.T_OC;
  AddCalibration(estimate);
  const double unseen = Seconds(frame.stamp - good_stamp_);
  if (state != TrackingState::kLost && unseen == 0.0 && step_time_ > 0.0) {
    // T_step maps from the previous camera to this one; the motion is its inverse.
    estimate.v_OC_C = -T_step_.translation() / step_time_;
    estimate.w_OC_C = -VectorFromRotation(T_step_.linear()) / step_time_;
  } else if (unseen > 0.0 && !window_.empty()) {
    Unseen(unseen, estimate.covariance);
  }
  return estimate;
}

void VisualOdometry::Unseen(double seconds, Matrix6d& covariance) const {
  const double speed = step_time_ > 0.0 ? T_step_.translation().norm() / step_time_ : 0.0;
  const double turn_rate = step_time_ > 0.0 ? VectorFromRotation(T_step_.linear()).norm() / step_time_ : 0.0;
  const double distance = (speed + options_.lost_speed) * seconds;
  const double turn = std::min(kAnyTurn, (turn_rate + options_.lost_turn_rate) * seconds);
  covariance.diagonal().head<3>().array() += distance * distance;
  covariance.diagonal().tail<3>().array() += turn * turn;
}

}  // namespace thalweg::visual_odometry
