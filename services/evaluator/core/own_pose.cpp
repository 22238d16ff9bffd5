#include "services/evaluator/core/own_pose.h"

#include <algorithm>

namespace thalweg::evaluator {
namespace {

using visual_odometry::TrackingState;

constexpr std::size_t kOneThread = 1;  // the campaign runs in parallel, so each run uses one thread

cv::Mat View(simulator::RenderedImage& image) {
  return {image.height_px, image.width_px, CV_8UC1, image.data.data()};
}

}  // namespace

OwnPose::OwnPose(const Options& options, const RigidTransform& T_BC, const RigidTransform& T_WB_start,
                 std::uint32_t noise_seed)
    : period_(FromSeconds(1.0 / options.camera.rate)),
      T_BC_(T_BC),
      T_WO_(T_WB_start * T_BC),
      rig_(options.camera, noise_seed, kOneThread),
      odometry_({options.camera.camera, options.camera.baseline}, options.estimator) {}

std::optional<RigidTransform> OwnPose::Look(const simulator::World& world, const RigidTransform& T_WB_true,
                                            Time now) {
  next_ = now + period_;
  simulator::StereoPair pair = rig_.Capture(world, T_WB_true * T_BC_);
  const bool was_lost = figures_.frames > 0 && last_.state == TrackingState::kLost;
  last_ = odometry_.Track({now, View(pair.left), View(pair.right)});
  ++figures_.frames;
  if (last_.state == TrackingState::kDegraded) ++figures_.degraded;
  if (last_.state == TrackingState::kLost) {
    ++figures_.lost;
    if (!was_lost) ++figures_.losses;
    return std::nullopt;
  }
  const RigidTransform T_WB = T_WO_ * last_.T_OC * T_BC_.inverse();
  figures_.drift = (T_WB.translation() - T_WB_true.translation()).norm();
  figures_.greatest_drift = std::max(figures_.greatest_drift, figures_.drift);
  return T_WB;
}

}  // namespace thalweg::evaluator
