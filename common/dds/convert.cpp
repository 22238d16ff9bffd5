#include "common/dds/convert.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/text.h"

namespace thalweg::dds {
namespace {

constexpr double kFarthest = 1e6;  // [m] values beyond are invalid

Error BadField(std::string_view field, const std::string& value, std::string_view allowed) {
  return Error{std::string(field) + " is " + value + ", must be " + std::string(allowed)};
}

/// A frame under another name than expected, and how to have it so.
Error BadFrame(std::string_view field, const std::string& frame, std::string_view expected) {
  const std::string_view setting = expected == kCameraFrame ? "camera" : expected;
  return BadField(field, '"' + frame + '"',
                  '"' + std::string(expected) + "\" or what frames." + std::string(setting) + " says");
}

template <class Message>
Message XyzToIdl(const Eigen::Vector3d& v) {
  Message message;
  message.x(v.x());
  message.y(v.y());
  message.z(v.z());
  return message;
}

geometry_msgs::msg::Quaternion QuaternionToIdl(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  geometry_msgs::msg::Quaternion message;
  message.x(q.x());
  message.y(q.y());
  message.z(q.z());
  message.w(q.w());
  return message;
}

geometry_msgs::msg::TransformStamped TransformToIdl(Time stamp, const char* parent, const char* child,
                                                    const RigidTransform& T) {
  geometry_msgs::msg::TransformStamped message;
  message.header(MakeHeader(stamp, parent));
  message.child_frame_id(child);
  message.transform().translation(XyzToIdl<geometry_msgs::msg::Vector3>(T.translation()));
  message.transform().rotation(QuaternionToIdl(T.linear()));
  return message;
}

}  // namespace

builtin_interfaces::msg::Time ToIdl(Time time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  builtin_interfaces::msg::Time message;
  message.sec(static_cast<std::int32_t>(seconds.time_since_epoch().count()));
  message.nanosec(static_cast<std::uint32_t>((time - seconds).count()));
  return message;
}

Result<Time> FromIdl(const builtin_interfaces::msg::Time& time) {
  if (time.sec() < 0) return BadField("stamp.sec", std::to_string(time.sec()), ">= 0");
  if (time.nanosec() >= 1'000'000'000) {
    return BadField("stamp.nanosec", std::to_string(time.nanosec()), "< 1000000000");
  }
  return Time{std::chrono::seconds(time.sec()) + Duration(time.nanosec())};
}

std_msgs::msg::Header MakeHeader(Time stamp, std::string_view frame) {
  std_msgs::msg::Header header;
  header.stamp(ToIdl(stamp));
  header.frame_id(std::string(frame));
  return header;
}

Result<Time> FromIdl(const std_msgs::msg::Header& header, std::string_view frame) {
  if (header.frame_id() != frame) {
    return BadFrame("frame_id", header.frame_id(), frame);
  }
  return FromIdl(header.stamp());
}

geometry_msgs::msg::Pose ToIdl(const RigidTransform& T) {
  geometry_msgs::msg::Pose pose;
  pose.position(XyzToIdl<geometry_msgs::msg::Point>(T.translation()));
  pose.orientation(QuaternionToIdl(T.linear()));
  return pose;
}

Result<RigidTransform> FromIdl(const geometry_msgs::msg::Pose& pose) {
  const Eigen::Vector3d position(pose.position().x(), pose.position().y(), pose.position().z());
  // Written so that NaN fails, too.
  if (!(position.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthest)) {
    return BadField("position",
                    std::to_string(position.x()) + ", " + std::to_string(position.y()) + ", " +
                        std::to_string(position.z()),
                    "finite and within 1e6 m");
  }
  const Eigen::Quaterniond q(pose.orientation().w(), pose.orientation().x(), pose.orientation().y(),
                             pose.orientation().z());
  if (!(std::abs(q.norm() - 1.0) <= 0.01)) {
    return BadField("length of orientation", NumberText(q.norm()), "1");
  }
  return MakeTransform(q.normalized().toRotationMatrix(), position);
}

nav_msgs::msg::Odometry OdometryToIdl(Time stamp, const RigidTransform& T_WB, const Eigen::Vector3d& v_WB_B,
                                      const Eigen::Vector3d& w_WB_B) {
  nav_msgs::msg::Odometry odometry;
  odometry.header(MakeHeader(stamp, kOdometryFrame));
  odometry.child_frame_id(kBodyFrame);
  odometry.pose().pose(ToIdl(T_WB));
  odometry.twist().twist(TwistToIdl(v_WB_B, w_WB_B));
  return odometry;
}

Result<StampedPose> FromIdl(const nav_msgs::msg::Odometry& odometry) {
  const Result<Time> stamp = FromIdl(odometry.header(), kOdometryFrame);
  if (!stamp) return Error{stamp.error()};
  if (odometry.child_frame_id() != kBodyFrame) {
    return BadFrame("child_frame_id", odometry.child_frame_id(), kBodyFrame);
  }
  const Result<RigidTransform> T_WB = FromIdl(odometry.pose().pose());
  if (!T_WB) return Error{T_WB.error()};
  return StampedPose{*stamp, *T_WB};
}

geometry_msgs::msg::PoseStamped PoseStampedToIdl(Time stamp, const RigidTransform& T_WB) {
  geometry_msgs::msg::PoseStamped message;
  message.header(MakeHeader(stamp, kMapFrame));
  message.pose(ToIdl(T_WB));
  return message;
}

Result<StampedPose> FromIdl(const geometry_msgs::msg::PoseStamped& pose) {
  const Result<Time> stamp = FromIdl(pose.header(), kMapFrame);
  if (!stamp) return Error{stamp.error()};
  const Result<RigidTransform> T_WB = FromIdl(pose.pose());
  if (!T_WB) return Error{T_WB.error()};
  return StampedPose{*stamp, *T_WB};
}

tf2_msgs::msg::TFMessage TransformsToIdl(Time stamp, const RigidTransform& T_WB, const RigidTransform& T_BC) {
  tf2_msgs::msg::TFMessage message;
  message.transforms({TransformToIdl(stamp, kMapFrame, kOdometryFrame, RigidTransform::Identity()),
                      TransformToIdl(stamp, kOdometryFrame, kBodyFrame, T_WB),
                      TransformToIdl(stamp, kBodyFrame, kCameraFrame, T_BC)});
  return message;
}

tf2_msgs::msg::TFMessage StaticTransformsToIdl(Time stamp, const std::optional<RigidTransform>& T_BC) {
  tf2_msgs::msg::TFMessage message;
  message.transforms({TransformToIdl(stamp, kMapFrame, kOdometryFrame, RigidTransform::Identity())});
  if (T_BC) message.transforms().push_back(TransformToIdl(stamp, kBodyFrame, kCameraFrame, *T_BC));
  return message;
}

geometry_msgs::msg::Twist TwistToIdl(const Eigen::Vector3d& v_WB_B, const Eigen::Vector3d& w_WB_B) {
  geometry_msgs::msg::Twist twist;
  twist.linear(XyzToIdl<geometry_msgs::msg::Vector3>(v_WB_B));
  twist.angular(XyzToIdl<geometry_msgs::msg::Vector3>(w_WB_B));
  return twist;
}

geometry_msgs::msg::TwistStamped TwistStampedToIdl(Time stamp, const geometry_msgs::msg::Twist& twist) {
  geometry_msgs::msg::TwistStamped message;
  message.header(MakeHeader(stamp, kBodyFrame));
  message.twist(twist);
  return message;
}

nav_msgs::msg::Path ToIdl(const StampedPath& path) {
  nav_msgs::msg::Path message;
  message.header(MakeHeader(path.stamp, kMapFrame));
  message.poses().reserve(path.T_WBs.size());
  for (const RigidTransform& T_WB : path.T_WBs) message.poses().push_back(PoseStampedToIdl(path.stamp, T_WB));
  return message;
}

Result<StampedPath> FromIdl(const nav_msgs::msg::Path& path) {
  const Result<Time> stamp = FromIdl(path.header(), kMapFrame);
  if (!stamp) return Error{stamp.error()};
  StampedPath result{.stamp = *stamp, .T_WBs = {}};
  result.T_WBs.reserve(path.poses().size());
  for (const geometry_msgs::msg::PoseStamped& pose : path.poses()) {
    const std::string where = "poses[" + std::to_string(result.T_WBs.size()) + "].";
    const std::string& frame = pose.header().frame_id();
    if (!frame.empty() && frame != kMapFrame) {
      return BadField(where + "frame_id", '"' + frame + '"', '"' + std::string(kMapFrame) + '"');
    }
    const Result<RigidTransform> T_WB = FromIdl(pose.pose());
    if (!T_WB) return Error{where + T_WB.error()};
    result.T_WBs.push_back(*T_WB);
  }
  return result;
}

thalweg_msgs::msg::ScanView ToIdl(Time stamp, const ScanView& scan) {
  thalweg_msgs::msg::ScanView message;
  message.stamp(ToIdl(stamp));
  message.map_from_camera(ToIdl(scan.T_WC));
  if (scan.measured) message.measured({scan.measured->of_255.begin(), scan.measured->of_255.end()});
  return message;
}

Result<ScanView> FromIdl(const thalweg_msgs::msg::ScanView& scan) {
  const Result<RigidTransform> T_WC = FromIdl(scan.map_from_camera());
  if (!T_WC) return Error{T_WC.error()};
  ScanView result{.T_WC = *T_WC};
  if (scan.measured().empty()) return result;
  MeasuredShares shares;
  if (scan.measured().size() != shares.of_255.size()) {
    return BadField("length of measured", std::to_string(scan.measured().size()),
                    "0 or " + std::to_string(shares.of_255.size()));
  }
  std::copy(scan.measured().begin(), scan.measured().end(), shares.of_255.begin());
  result.measured = shares;
  return result;
}

thalweg_msgs::msg::Timing ToIdl(const std::string& name, const TimingStatistics::Summary& summary) {
  thalweg_msgs::msg::Timing message;
  message.name(name);
  message.count(summary.count);
  message.p50_ms(summary.p50_ms);
  message.p95_ms(summary.p95_ms);
  message.max_ms(summary.max_ms);
  return message;
}

}  // namespace thalweg::dds
