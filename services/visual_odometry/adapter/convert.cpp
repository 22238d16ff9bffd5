#include "services/visual_odometry/adapter/convert.h"

#include <opencv2/imgproc.hpp>

#include "common/base/check.h"

namespace thalweg::visual_odometry {

cv::Mat ToGray(const dds::ImageView& view) {
  const bool color = view.encoding == "rgb8" || view.encoding == "bgr8";
  // OpenCV's type has no read-only view; the image is only read here.
  const cv::Mat seen(view.height_px, view.width_px, color ? CV_8UC3 : CV_8UC1,
                     const_cast<std::uint8_t*>(view.data),  // NOLINT(cppcoreguidelines-pro-type-const-cast)
                     static_cast<std::size_t>(view.step_bytes));
  cv::Mat gray;
  if (view.encoding == "mono8") {
    seen.copyTo(gray);
  } else if (view.encoding == "rgb8") {
    cv::cvtColor(seen, gray, cv::COLOR_RGB2GRAY);
  } else if (view.encoding == "bgr8") {
    cv::cvtColor(seen, gray, cv::COLOR_BGR2GRAY);
  } else if (view.encoding == "bayer_rggb8") {
    cv::cvtColor(seen, gray, cv::COLOR_BayerRGGB2GRAY);
  } else if (view.encoding == "bayer_bggr8") {
    cv::cvtColor(seen, gray, cv::COLOR_BayerBGGR2GRAY);
  } else if (view.encoding == "bayer_gbrg8") {
    cv::cvtColor(seen, gray, cv::COLOR_BayerGBRG2GRAY);
  } else {
    THALWEG_CHECK(view.encoding == "bayer_grbg8");
    cv::cvtColor(seen, gray, cv::COLOR_BayerGRBG2GRAY);
  }
  return gray;
}

BodyMotion BodyMotionFrom(const PoseEstimate& estimate, const RigidTransform& T_WO,
                          const RigidTransform& T_BC) {
  BodyMotion motion;
  motion.T_WB = T_WO * estimate.T_OC * T_BC.inverse();
  const Eigen::Matrix3d R_BC = T_BC.linear();
  motion.w_WB_B = R_BC * estimate.w_OC_C;
  motion.v_WB_B = R_BC * estimate.v_OC_C - motion.w_WB_B.cross(T_BC.translation());
  Matrix6d to_W = Matrix6d::Zero();
  to_W.topLeftCorner<3, 3>() = motion.T_WB.linear();
  to_W.bottomRightCorner<3, 3>() = motion.T_WB.linear();
  to_W = to_W * Adjoint(T_BC);
  motion.covariance_W = to_W * estimate.covariance * to_W.transpose();
  return motion;
}

nav_msgs::msg::Odometry ToIdl(Time stamp, const BodyMotion& motion) {
  nav_msgs::msg::Odometry message = dds::OdometryToIdl(stamp, motion.T_WB, motion.v_WB_B, motion.w_WB_B);
  for (Eigen::Index i = 0; i < 36; ++i) {
    message.pose().covariance()[static_cast<std::size_t>(i)] = motion.covariance_W(i / 6, i % 6);
  }
  return message;
}

}  // namespace thalweg::visual_odometry
