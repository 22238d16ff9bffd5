#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/base/statistics.h"
#include "common/base/time.h"
#include "common/dds/topics.h"
#include "common/geometry/depth_image.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/scan_view.h"

namespace thalweg::dds {

// Conversions between messages and core types. FromIdl validates messages from outside, once: its errors name
// the field and its value. ToIdl cannot fail.

builtin_interfaces::msg::Time ToIdl(Time time);
/// Error: nanosec >= 1e9, or a time before the epoch.
Result<Time> FromIdl(const builtin_interfaces::msg::Time& time);

std_msgs::msg::Header MakeHeader(Time stamp, std::string_view frame);
/// Returns the stamp. Error: invalid time, or a frame other than `frame`.
Result<Time> FromIdl(const std_msgs::msg::Header& header, std::string_view frame);

geometry_msgs::msg::Pose ToIdl(const RigidTransform& T);
/// Error: values that are not finite or beyond 1e6 m, or a quaternion whose norm differs from 1 by more than
/// 1 %.
Result<RigidTransform> FromIdl(const geometry_msgs::msg::Pose& pose);

struct StampedPose {
  Time stamp;
  RigidTransform T;
};

nav_msgs::msg::Odometry OdometryToIdl(Time stamp, const RigidTransform& T_WB, const Eigen::Vector3d& v_WB_B,
                                      const Eigen::Vector3d& w_WB_B);
/// Returns the pose; twist and covariances are not used and not checked. Error: as for a pose, or frames
/// other than odom and base_link.
Result<StampedPose> FromIdl(const nav_msgs::msg::Odometry& odometry);

geometry_msgs::msg::PoseStamped PoseStampedToIdl(Time stamp, const RigidTransform& T_WB);
Result<StampedPose> FromIdl(const geometry_msgs::msg::PoseStamped& pose);

/// The transforms odom -> base_link -> camera_optical_frame, and map -> odom as the identity, for
/// visualization tools.
tf2_msgs::msg::TFMessage TransformsToIdl(Time stamp, const RigidTransform& T_WB, const RigidTransform& T_BC);

/// Those that do not change, for tf_static: map -> odom, which coincide, and base_link ->
/// camera_optical_frame unless somebody else says where the camera is.
tf2_msgs::msg::TFMessage StaticTransformsToIdl(Time stamp, const std::optional<RigidTransform>& T_BC);

/// Velocities of the body in its own frame, in [m/s] and [rad/s].
geometry_msgs::msg::Twist TwistToIdl(const Eigen::Vector3d& v_WB_B, const Eigen::Vector3d& w_WB_B);
geometry_msgs::msg::TwistStamped TwistStampedToIdl(Time stamp, const geometry_msgs::msg::Twist& twist);

struct StampedPath {
  Time stamp;                         ///< Identifies the path: an equal stamp means the same path.
  std::vector<RigidTransform> T_WBs;  ///< Empty = stop.
};

nav_msgs::msg::Path ToIdl(const StampedPath& path);
/// Error: as for a pose, or a pose whose frame is neither the map's nor empty (which means the map's).
Result<StampedPath> FromIdl(const nav_msgs::msg::Path& path);

struct StampedCloud {
  Time stamp;
  PointCloud cloud;
};

/// Encodes fields x, y, z as float32, and if there are colors, rgb packed as in PCL and ROS (0x00rrggbb in a
/// float32).
sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const PointCloud& cloud);
/// A point in the map frame with a value. Encoded in one row, with fields x, y, z and intensity as float32.
struct ValuedPoint {
  Eigen::Vector3f p_W;  ///< [m]
  float value;
};
sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const std::vector<ValuedPoint>& points);
/// A point in the map frame with a color. Encoded in one row, with fields x, y, z and rgb as above.
struct ColoredPoint {
  Eigen::Vector3f p_W;  ///< [m]
  Rgb color;
};
sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const std::vector<ColoredPoint>& points);
/// Meaning of a point with z = +infinity.
enum class Infinity : std::uint8_t {
  kNoMeasurement,  ///< Not measured, as many drivers encode it.
  kNoReturn,       ///< Nothing lies within the sensor's range there; only for sensors known to encode that.
};
/// Accepts any layout with x, y, z as float32, with or without rgb. Points that are not finite or beyond 1e6
/// m become NaN; with kNoReturn, those with z = +infinity become NoReturn(), whatever x and y are. Error:
/// size fields that disagree with the data, no points, big-endian data, missing or misplaced fields, unknown
/// frame.
Result<StampedCloud> FromIdl(const sensor_msgs::msg::PointCloud2& cloud,
                             Infinity infinity = Infinity::kNoMeasurement);

/// A validated image, not copied: it points into the message.
struct ImageView {
  Time stamp;
  int width_px = 0;
  int height_px = 0;
  int step_bytes = 0;
  std::string_view encoding;  ///< mono8, rgb8, bgr8 or bayer_{rggb,bggr,gbrg,grbg}8.
  const std::uint8_t* data = nullptr;
};
/// Error: size fields that disagree with the data, no pixels, unsupported encoding, unknown frame.
Result<ImageView> FromIdl(const sensor_msgs::msg::Image& image);
/// @param bytes  height * width * channels bytes, rows without padding.
struct StampedDepth {
  Time stamp;
  DepthImage image;
};
/// Accepts encodings 16UC1 in millimeters, where 0 = not measured, and 32FC1 in meters, where what is not
/// finite and positive = not measured [REP 118]; with kNoReturn, +infinity = nothing in range. Error: size
/// fields that disagree with the data, no pixels, another encoding, big-endian data, unknown frame.
Result<StampedDepth> DepthFromIdl(const sensor_msgs::msg::Image& image,
                                  Infinity infinity = Infinity::kNoMeasurement);
sensor_msgs::msg::Image ToIdl(Time stamp, std::string_view frame, int width_px, int height_px,
                              std::string_view encoding, std::vector<std::uint8_t> bytes);

/// Describes an ideal, rectified camera.
/// @param baseline  [m] Distance from the left camera; 0 for the left camera itself.
sensor_msgs::msg::CameraInfo ToIdl(Time stamp, const PinholeCamera& camera, double baseline);

struct StampedCamera {
  Time stamp;
  PinholeCamera camera;   ///< The rectified image's.
  double baseline = 0.0;  ///< [m] Distance from the left camera.
};
/// Error: no pixels, focal lengths that are not finite and positive, a principal point or baseline that is
/// not finite, a baseline < 0, unknown frame.
Result<StampedCamera> FromIdl(const sensor_msgs::msg::CameraInfo& info);

thalweg_msgs::msg::ScanView ToIdl(Time stamp, const ScanView& scan);
/// Returns pose and shares; the stamp is not used and not checked. Error: as for a pose, or a number of
/// shares that is neither 0 nor that of the cells.
Result<ScanView> FromIdl(const thalweg_msgs::msg::ScanView& scan);

thalweg_msgs::msg::Timing ToIdl(const std::string& name, const TimingStatistics::Summary& summary);

}  // namespace thalweg::dds
