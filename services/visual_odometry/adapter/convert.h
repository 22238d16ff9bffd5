#pragma once

#include <opencv2/core.hpp>

#include "common/dds/convert.h"
#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::visual_odometry {

/// Copies an image of any encoding to grayscale.
cv::Mat ToGray(const dds::ImageView& view);

/// Pose, velocity and covariance of our body.
struct BodyMotion {
  RigidTransform T_WB = RigidTransform::Identity();
  Eigen::Vector3d v_WB_B = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();
  Matrix6d covariance_W = Matrix6d::Zero();  ///< (position, rotation) in the axes of W, as in ROS.
};

/// Converts the camera's estimate to the motion of the body.
/// @param T_WO  Pose of the left camera at the estimator's first frame.
BodyMotion BodyMotionFrom(const PoseEstimate& estimate, const RigidTransform& T_WO,
                          const RigidTransform& T_BC);

nav_msgs::msg::Odometry ToIdl(Time stamp, const BodyMotion& motion);

}  // namespace thalweg::visual_odometry
