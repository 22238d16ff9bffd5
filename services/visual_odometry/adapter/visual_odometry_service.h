#pragma once

#include <optional>

#include "common/base/stamp_pairs.h"
#include "common/dds/bus.h"
#include "services/visual_odometry/adapter/convert.h"
#include "services/visual_odometry/adapter/options.h"
#include "services/visual_odometry/adapter/trajectory_file.h"

namespace thalweg::visual_odometry {

/// Publishes the pose of the body, estimated from its own images or taken from another source. While tracking
/// is lost it publishes no odometry, which stops the controller, but reports the reason in its status.
class VisualOdometryService {
 public:
  /// Throws std::runtime_error if a trajectory file cannot be read.
  VisualOdometryService(const VisualOdometryOptions& options, dds::Bus& bus);

 private:
  template <class Topic>
  void SubscribeCamera(std::optional<dds::StampedCamera>& camera);
  template <class Topic>
  void OnImage(const sensor_msgs::msg::Image& message, bool is_left);
  void TrackPair(const StereoImages& images);
  bool MakeEstimator();
  void OnOutsidePose(const char* topic, const std_msgs::msg::Header& header,
                     const geometry_msgs::msg::Pose& pose);
  void OnTruth(const nav_msgs::msg::Odometry& message);
  void PublishFromFile();

  void Publish(Time stamp, const BodyMotion& motion);
  void PublishStatus(Time stamp, TrackingState state, const std::string& reason, std::uint32_t inliers,
                     double position_sigma, double orientation_sigma);

  VisualOdometryOptions options_;
  dds::Bus& bus_;

  // STEREO only.
  std::optional<dds::StampedCamera> left_camera_;
  std::optional<dds::StampedCamera> right_camera_;
  StampPairs<cv::Mat> pairs_;
  std::optional<StereoImages> early_;  ///< The newest, while the camera_infos have not arrived yet.
  std::optional<VisualOdometry> odometry_;
  RigidTransform T_WO_ = RigidTransform::Identity();

  std::optional<Trajectory> file_;
  std::optional<Time> outside_stamp_;
  std::optional<BodyMotion> outside_last_;

  std::optional<TrackingState> last_state_;
  bool calibration_off_ = false;  ///< As last logged.
  std::uint64_t measurements_ = 0;
  std::uint64_t degraded_ = 0;
  std::uint64_t lost_ = 0;

  dds::Bus::Publisher<dds::topics::Odometry> odometry_out_;
  dds::Bus::Publisher<dds::topics::Transforms> transforms_out_;
  dds::Bus::Publisher<dds::topics::OdometryStatus> status_out_;
};

}  // namespace thalweg::visual_odometry
