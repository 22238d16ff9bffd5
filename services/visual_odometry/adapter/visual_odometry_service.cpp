#include "services/visual_odometry/adapter/visual_odometry_service.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <limits>
#include <utility>

#include "common/base/stopwatch.h"
#include "services/visual_odometry/adapter/text.h"

namespace thalweg::visual_odometry {
namespace {

namespace topics = dds::topics;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

thalweg_msgs::msg::OdometryState StateToIdl(TrackingState state) {
  switch (state) {
    case TrackingState::kTracking:
      return thalweg_msgs::msg::ODOMETRY_TRACKING;
    case TrackingState::kDegraded:
      return thalweg_msgs::msg::ODOMETRY_DEGRADED;
    case TrackingState::kLost:
      break;
  }
  return thalweg_msgs::msg::ODOMETRY_LOST;
}

thalweg_msgs::msg::OdometrySource SourceToIdl(Source source) {
  switch (source) {
    case Source::kTopic:
      return thalweg_msgs::msg::ODOMETRY_FROM_TOPIC;
    case Source::kFile:
      return thalweg_msgs::msg::ODOMETRY_FROM_FILE;
    case Source::kTruth:
      return thalweg_msgs::msg::ODOMETRY_FROM_TRUTH;
    case Source::kStereo:
      break;
  }
  return thalweg_msgs::msg::ODOMETRY_FROM_STEREO;
}

/// The motion of our body between two poses.
BodyMotion MotionTo(const RigidTransform& T_WB, const std::optional<BodyMotion>& last, double passed) {
  BodyMotion motion;
  motion.T_WB = T_WB;
  if (!last || passed <= 0.0) return motion;
  const RigidTransform step = last->T_WB.inverse() * T_WB;
  const Eigen::AngleAxisd turn(step.linear());
  motion.v_WB_B = T_WB.linear().transpose() * (T_WB.translation() - last->T_WB.translation()) / passed;
  motion.w_WB_B = turn.angle() / passed * turn.axis();
  return motion;
}

}  // namespace

VisualOdometryService::VisualOdometryService(const VisualOdometryOptions& options, dds::Bus& bus)
    : options_(options),
      bus_(bus),
      odometry_out_(bus.Advertise<topics::Odometry>()),
      transforms_out_(bus.Advertise<topics::Transforms>()),
      status_out_(bus.Advertise<topics::OdometryStatus>()) {
  switch (options.source) {
    case Source::kStereo:
      SubscribeCamera<topics::LeftCameraInfo>(left_camera_);
      SubscribeCamera<topics::RightCameraInfo>(right_camera_);
      bus.Subscribe<topics::LeftImage>([this](const auto& m) { OnImage<topics::LeftImage>(m, true); });
      bus.Subscribe<topics::RightImage>([this](const auto& m) { OnImage<topics::RightImage>(m, false); });
      break;
    case Source::kTopic:
      if (options.topic_type == TopicType::kPose) {
        const std::string name = options.topic.empty() ? topics::OutsidePose::kName : options.topic;
        bus.SubscribeTo<topics::OutsidePose>(name, [this](const auto& message) {
          OnOutsidePose(topics::OutsidePose::kName, message.header(), message.pose());
        });
      } else {
        const std::string name = options.topic.empty() ? topics::OutsideOdometry::kName : options.topic;
        bus.SubscribeTo<topics::OutsideOdometry>(name, [this](const auto& message) {
          OnOutsidePose(topics::OutsideOdometry::kName, message.header(), message.pose().pose());
        });
      }
      break;
    case Source::kFile:
      file_.emplace(ReadTrajectory(options.file, options.file_rate), options.longest_gap);
      spdlog::info("{}: {} poses", options.file.string(), file_->poses().size());
      bus.Every(FromSeconds(1.0 / options.rate), [this] { PublishFromFile(); });
      break;
    case Source::kTruth:
      bus.Subscribe<topics::TrueOdometry>([this](const auto& message) { OnTruth(message); });
      break;
  }
}

template <class Topic>
void VisualOdometryService::SubscribeCamera(std::optional<dds::StampedCamera>& camera) {
  bus_.Subscribe<Topic>([this, &camera](const auto& message) {
    const auto its_camera = dds::FromIdl(message);
    if (!its_camera) return bus_.health().template Reject<Topic>(its_camera.error());
    camera = *its_camera;
    if (early_ && MakeEstimator()) TrackPair(*std::exchange(early_, std::nullopt));
  });
}

template <class Topic>
void VisualOdometryService::OnImage(const sensor_msgs::msg::Image& message, bool is_left) {
  const auto view = dds::FromIdl(message);
  if (!view) return bus_.health().Reject<Topic>(view.error());
  if (pairs_.ClearIfRestarted(view->stamp)) early_.reset();
  const auto pair =
      is_left ? pairs_.AddLeft(view->stamp, ToGray(*view)) : pairs_.AddRight(view->stamp, ToGray(*view));
  for (std::size_t n = pairs_.TakeDropped(); n > 0; --n) {
    bus_.health().Drop<Topic>("the image of the other camera is missing");
  }
  if (!pair) return;
  const StereoImages images{view->stamp, pair->first, pair->second};
  if (MakeEstimator()) return TrackPair(images);
  if (early_) bus_.health().Drop<Topic>("no camera_info has come yet");
  early_ = images;
}

bool VisualOdometryService::MakeEstimator() {
  if (odometry_) return true;
  if (!left_camera_ || !right_camera_) return false;
  try {
    odometry_.emplace(StereoGeometry{left_camera_->camera, right_camera_->baseline}, options_.estimator);
  } catch (const std::invalid_argument& error) {
    bus_.health().Reject<topics::RightCameraInfo>(error.what());
    return false;
  }
  T_WO_ = options_.T_WB_start * options_.T_BC;
  return true;
}

void VisualOdometryService::TrackPair(const StereoImages& images) {
  const Time stamp = images.stamp;
  const Stopwatch watch;
  PoseEstimate estimate;
  try {
    estimate = odometry_->Track(images);
  } catch (const std::invalid_argument& error) {
    return bus_.health().Reject<topics::LeftImage>(error.what());
  }
  bus_.health().Timed("track", watch.Milliseconds());
  const bool off = estimate.calibration.off_probability > 0.5;
  if (off && !calibration_off_) {
    spdlog::warn("the calibration of the stereo camera is off by about {:.1f} px; corrected to {:.2f} px",
                 estimate.calibration.offset_px, estimate.calibration.left_px);
  }
  calibration_off_ = off;
  if (estimate.state != TrackingState::kLost) Publish(stamp, BodyMotionFrom(estimate, T_WO_, options_.T_BC));
  const auto sigma = [](const auto& covariance) { return std::sqrt(covariance.trace()); };
  PublishStatus(
      stamp, estimate.state, ReasonText(estimate.reason), static_cast<std::uint32_t>(estimate.inliers),
      sigma(estimate.covariance.topLeftCorner<3, 3>()), sigma(estimate.covariance.bottomRightCorner<3, 3>()));
}

void VisualOdometryService::OnOutsidePose(const char* topic, const std_msgs::msg::Header& header,
                                          const geometry_msgs::msg::Pose& pose) {
  // The frame names of outside poses are not checked: the scenario says what they are.
  const auto stamp = dds::FromIdl(header.stamp());
  if (!stamp) return bus_.health().Reject(topic, stamp.error());
  const auto T_WX = dds::FromIdl(pose);
  if (!T_WX) return bus_.health().Reject(topic, T_WX.error());
  if (outside_stamp_ && *stamp <= *outside_stamp_ && *outside_stamp_ - *stamp < kClockRestart) {
    return PublishStatus(*stamp, TrackingState::kDegraded, "time runs backwards", 0, kUnknown, kUnknown);
  }
  const double passed = outside_stamp_ ? Seconds(*stamp - *outside_stamp_) : 0.0;
  const BodyMotion motion = MotionTo(*T_WX * options_.T_XB, outside_last_, passed);
  outside_stamp_ = *stamp;
  outside_last_ = motion;
  Publish(*stamp, motion);
  PublishStatus(*stamp, TrackingState::kTracking, "", 0, kUnknown, kUnknown);
}

void VisualOdometryService::OnTruth(const nav_msgs::msg::Odometry& message) {
  const auto pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::TrueOdometry>(pose.error());
  odometry_out_.Write(message);
  transforms_out_.Write(dds::TransformsToIdl(pose->stamp, pose->T, options_.T_BC));
  PublishStatus(pose->stamp, TrackingState::kTracking, "", 0, 0.0, 0.0);
}

void VisualOdometryService::PublishFromFile() {
  const Time now = bus_.Now();
  const auto T_WX = file_->At(now - options_.file_offset);
  if (!T_WX) {
    outside_last_.reset();
    return PublishStatus(now, TrackingState::kLost, "the file has no pose of this time", 0, kUnknown,
                         kUnknown);
  }
  const double passed = outside_stamp_ ? Seconds(now - *outside_stamp_) : 0.0;
  const BodyMotion motion = MotionTo(*T_WX * options_.T_XB, outside_last_, passed);
  outside_stamp_ = now;
  outside_last_ = motion;
  Publish(now, motion);
  PublishStatus(now, TrackingState::kTracking, "", 0, kUnknown, kUnknown);
}

void VisualOdometryService::Publish(Time stamp, const BodyMotion& motion) {
  odometry_out_.Write(ToIdl(stamp, motion));
  transforms_out_.Write(dds::TransformsToIdl(stamp, motion.T_WB, options_.T_BC));
}

void VisualOdometryService::PublishStatus(Time stamp, TrackingState state, const std::string& reason,
                                          std::uint32_t inliers, double position_sigma,
                                          double orientation_sigma) {
  if (last_state_ != state) {
    spdlog::log(state == TrackingState::kTracking ? spdlog::level::info : spdlog::level::warn, "{}{}{}",
                NameOf(state), reason.empty() ? "" : ": ", reason);
    last_state_ = state;
  }
  ++measurements_;
  degraded_ += state == TrackingState::kDegraded ? 1 : 0;
  lost_ += state == TrackingState::kLost ? 1 : 0;
  thalweg_msgs::msg::OdometryStatus status;
  status.header(dds::MakeHeader(stamp, dds::kOdometryFrame));
  status.source(SourceToIdl(options_.source));
  status.state(StateToIdl(state));
  status.reason(reason);
  status.inliers(inliers);
  status.position_sigma_m(position_sigma);
  status.orientation_sigma_rad(orientation_sigma);
  status.measurements(measurements_);
  status.degraded(degraded_);
  status.lost(lost_);
  status_out_.Write(status);
}

}  // namespace thalweg::visual_odometry
