#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/base/statistics.h"
#include "common/base/time.h"
#include "common/dds/topics.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/point_cloud.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/scan_view.h"

namespace thalweg::dds {

// Messages to core types and back. FromIdl is where a message from outside is checked, once: its errors name
// the field and its value. ToIdl cannot fail.

builtin_interfaces::msg::Time ToIdl(Time time);
/// Error: nanosec >= 1e9, or before the epoch.
Result<Time> FromIdl(const builtin_interfaces::msg::Time& time);

std_msgs::msg::Header MakeHeader(Time stamp, std::string_view frame);
/// The stamp. Error: bad time, or a frame other than `frame`.
Result<Time> FromIdl(const std_msgs::msg::Header& header, std::string_view frame);

geometry_msgs::msg::Pose ToIdl(const RigidTransform& T);
/// Error: not finite, beyond 1e6 m, or a quaternion whose length differs from 1 by more than 1 %.
Result<RigidTransform> FromIdl(const geometry_msgs::msg::Pose& pose);

struct StampedPose {
  Time stamp;
  RigidTransform T;
};

nav_msgs::msg::Odometry OdometryToIdl(Time stamp, const RigidTransform& T_WB, const Eigen::Vector3d& v_WB_B,
                                      const Eigen::Vector3d& w_WB_B);
/// The pose; twist and covariances are nobody's input and are not looked at. Error: as for a pose, or other
/// frames than odom and base_link.
Result<StampedPose> FromIdl(const nav_msgs::msg::Odometry& odometry);

geometry_msgs::msg::PoseStamped PoseStampedToIdl(Time stamp, const RigidTransform& T_WB);
Result<StampedPose> FromIdl(const geometry_msgs::msg::PoseStamped& pose);

/// odom -> base_link -> camera_optical_frame, and map -> odom as the identity, for tools.
tf2_msgs::msg::TFMessage TransformsToIdl(Time stamp, const RigidTransform& T_WB, const RigidTransform& T_BC);

struct StampedPath {
  Time stamp;                         ///< Names the path: the same stamp is the same path again.
  std::vector<RigidTransform> T_WBs;  ///< Empty = stop.
};

nav_msgs::msg::Path ToIdl(const StampedPath& path);
/// Error: as for a pose, or a pose in another frame than the map's (an empty one is taken for it).
Result<StampedPath> FromIdl(const nav_msgs::msg::Path& path);

struct StampedCloud {
  Time stamp;
  PointCloud cloud;
};

/// Fields x, y, z float32 and, when there are colours, rgb packed as PCL and ROS do (0x00rrggbb in a
/// float32).
sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const PointCloud& cloud);
/// Points in the map frame with a value each: fields x, y, z and intensity, float32; a row.
struct ValuedPoint {
  Eigen::Vector3f p_W;  ///< [m]
  float value;
};
sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const std::vector<ValuedPoint>& points);
/// What a point with z = +infinity is.
enum class Infinity : std::uint8_t {
  kNoMeasurement,  ///< As many drivers mark what they could not measure.
  kNoReturn,       ///< From a sensor of which it is known that nothing is within its range there.
};
/// Takes any layout that has x, y, z as float32, with or without rgb. Points that are not finite or beyond
/// 1e6 m become NaN, those of kNoReturn with z = +infinity, whatever x and y are, NoReturn(). Error: size
/// fields that disagree with the data, no points, big-endian, missing or misplaced fields, unknown frame.
Result<StampedCloud> FromIdl(const sensor_msgs::msg::PointCloud2& cloud,
                             Infinity infinity = Infinity::kNoMeasurement);

/// A checked image, not copied: it points into the message.
struct ImageView {
  Time stamp;
  int width_px = 0;
  int height_px = 0;
  int step_bytes = 0;
  std::string_view encoding;  ///< mono8, rgb8, bgr8 or bayer_{rggb,bggr,gbrg,grbg}8.
  const std::uint8_t* data = nullptr;
};
/// Error: size fields that disagree with the data, no pixels, another encoding, unknown frame.
Result<ImageView> FromIdl(const sensor_msgs::msg::Image& image);
/// @param bytes  height * width * channels, rows without padding.
sensor_msgs::msg::Image ToIdl(Time stamp, std::string_view frame, int width_px, int height_px,
                              std::string_view encoding, std::vector<std::uint8_t> bytes);

/// Of an ideal, rectified camera. @param baseline  [m] to the left camera; 0 for the left camera itself.
sensor_msgs::msg::CameraInfo ToIdl(Time stamp, const PinholeCamera& camera, double baseline);

struct StampedCamera {
  Time stamp;
  PinholeCamera camera;   ///< Of the rectified image.
  double baseline = 0.0;  ///< [m] To the left camera.
};
/// Error: no pixels, focal lengths that are not finite and positive, a principal point or baseline that is
/// not finite, a baseline < 0, unknown frame.
Result<StampedCamera> FromIdl(const sensor_msgs::msg::CameraInfo& info);

thalweg_msgs::msg::ScanView ToIdl(Time stamp, const ScanView& scan);
/// Pose and shares; the stamp is nobody's input and is not looked at. Error: as for a pose, or shares that
/// are neither none nor one a cell.
Result<ScanView> FromIdl(const thalweg_msgs::msg::ScanView& scan);

thalweg_msgs::msg::Timing ToIdl(const std::string& name, const TimingStatistics::Summary& summary);

}  // namespace thalweg::dds
