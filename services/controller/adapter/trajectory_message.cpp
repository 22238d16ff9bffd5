#include "services/controller/adapter/trajectory_message.h"

#include "common/dds/convert.h"

namespace thalweg::controller {
namespace {

geometry_msgs::msg::Transform TransformOf(const RigidTransform& T_WB) {
  const geometry_msgs::msg::Pose pose = dds::ToIdl(T_WB);
  geometry_msgs::msg::Transform transform;
  transform.translation().x(pose.position().x());
  transform.translation().y(pose.position().y());
  transform.translation().z(pose.position().z());
  transform.rotation(pose.orientation());
  return transform;
}

builtin_interfaces::msg::Duration DurationOf(double seconds) {
  const builtin_interfaces::msg::Time time = dds::ToIdl(Time{} + FromSeconds(seconds));
  builtin_interfaces::msg::Duration duration;
  duration.sec(time.sec());
  duration.nanosec(time.nanosec());
  return duration;
}

}  // namespace

trajectory_msgs::msg::MultiDOFJointTrajectory TrajectoryToIdl(Time begin,
                                                              const std::vector<TrajectoryPoint>& points) {
  trajectory_msgs::msg::MultiDOFJointTrajectory message;
  message.header(dds::MakeHeader(begin, dds::kMapFrame));
  message.joint_names({dds::kBodyFrame});
  for (const TrajectoryPoint& point : points) {
    trajectory_msgs::msg::MultiDOFJointTrajectoryPoint out;
    out.transforms({TransformOf(point.T_WB)});
    out.velocities({dds::TwistToIdl(point.v_W, point.w_W)});
    out.accelerations({dds::TwistToIdl(point.a_W, Eigen::Vector3d::Zero())});
    out.time_from_start(DurationOf(point.time));
    message.points().push_back(std::move(out));
  }
  return message;
}

}  // namespace thalweg::controller
