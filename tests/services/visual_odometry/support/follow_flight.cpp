#include "tests/services/visual_odometry/support/follow_flight.h"

#include <algorithm>
#include <iostream>

#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::visual_odometry::test {

Outcome Follow(const simulator::World& world, const Flight& flight, double contrast) {
  const simulator::StereoRigModel model = NoisyRig();
  simulator::StereoRigModel clean = model;
  clean.noise_sigma = 0.0;
  simulator::StereoRig rig(contrast == 1.0 ? model : clean);
  VisualOdometry odometry(GeometryOf(model));
  Outcome outcome;
  std::vector<PosePair> poses;
  RigidTransform T_WK_true = flight.T_WCs.front();
  cv::RNG noise(1);
  bool warned = false;
  double traveled = 0.0;
  int inside_position = 0;
  int inside_rotation = 0;
  int measured = 0;
  for (std::size_t i = 0; i < flight.T_WCs.size(); ++i) {
    StereoImages images = Render(rig, world, flight, i);
    if (contrast != 1.0) {
      // Nearly blank walls: the texture fades, the noise stays.
      for (cv::Mat* image : {&images.left, &images.right}) {
        cv::Mat faded;
        image->convertTo(faded, CV_16S, contrast, 120.0);
        cv::Mat grain(image->size(), CV_16S);
        noise.fill(grain, cv::RNG::NORMAL, 0.0, model.noise_sigma);
        faded += grain;
        faded.convertTo(*image, CV_8U);
      }
    }
    const PoseEstimate estimate = odometry.Track(images);
    const RigidTransform& T_WC_true = flight.T_WCs[i];
    poses.push_back({estimate.stamp, estimate.T_OC, T_WC_true, estimate.covariance});
    if (i > 0) traveled += (T_WC_true.translation() - flight.T_WCs[i - 1].translation()).norm();
    outcome.not_tracking += estimate.state != TrackingState::kTracking;
    warned = warned || estimate.state != TrackingState::kTracking;
    if (!warned && traveled > 0.5) {
      const RigidTransform T_OC_true = flight.T_WCs.front().inverse() * T_WC_true;
      outcome.worst_while_tracking =
          std::max(outcome.worst_while_tracking,
                   (estimate.T_OC.translation() - T_OC_true.translation()).norm() / traveled);
    }
    if (i > 0 && estimate.state != TrackingState::kLost && estimate.inliers > 0) {
      const RigidTransform error = estimate.T_KC.inverse() * (T_WK_true.inverse() * T_WC_true);
      const Inside inside = InsideOf95Percent(error, estimate.covariance_KC);
      inside_position += inside.position ? 1 : 0;
      inside_rotation += inside.rotation ? 1 : 0;
      ++measured;
    }
    if (estimate.keyframe) T_WK_true = T_WC_true;
  }
  outcome.frames = static_cast<int>(poses.size());
  outcome.error = Compare(poses);
  outcome.inside_position = static_cast<double>(inside_position) / std::max(1, measured);
  outcome.inside_rotation = static_cast<double>(inside_rotation) / std::max(1, measured);
  return outcome;
}

void Print(const Outcome& outcome) {
  std::cout << outcome.frames << " frames, " << outcome.error.path_length << " m: end off by "
            << outcome.error.drift << " m, at most " << outcome.error.drift_max
            << " m; within the 95 % ellipsoid: position " << 100.0 * outcome.inside_position
            << " %, rotation " << 100.0 * outcome.inside_rotation << " % against the keyframe, "
            << 100.0 * outcome.error.inside_position << " and " << 100.0 * outcome.error.inside_rotation
            << " % against the start; " << outcome.not_tracking << " frames not tracking\n";
}

}  // namespace thalweg::visual_odometry::test
