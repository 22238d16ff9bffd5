#include "services/visual_odometry/adapter/options.h"

#include <stdexcept>

#include "common/geometry/angles.h"

namespace thalweg::visual_odometry {
namespace {

/// The robot's place in the map before it has moved.
RigidTransform StartFrom(const Scenario& scenario) {
  const thalweg::VisualOdometry& own = scenario.visual_odometry();
  const Simulator& simulator = scenario.simulator();
  if (!own.has_start_position_m() && simulator.start_seed() != 0) {
    throw std::invalid_argument(
        "visual_odometry.start_position_m is needed: with simulator.start_seed the start is not known");
  }
  RigidTransform T_WB = RigidTransform::Identity();
  if (own.has_start_position_m()) {
    T_WB.translation() = ToEigen(own.start_position_m());
  } else if (simulator.has_start_position_m()) {
    T_WB.translation() = ToEigen(simulator.start_position_m());
  }
  const double yaw_deg = own.has_start_yaw_deg() ? own.start_yaw_deg() : simulator.start_yaw_deg();
  T_WB.linear() = RotationFromYawPitch(yaw_deg * kDegree, 0.0);
  return T_WB;
}

Source SourceFrom(thalweg::VisualOdometry::Source source) {
  switch (source) {
    case thalweg::VisualOdometry::TOPIC:
      return Source::kTopic;
    case thalweg::VisualOdometry::FILE:
      return Source::kFile;
    case thalweg::VisualOdometry::TRUTH:
      return Source::kTruth;
    default:
      return Source::kStereo;
  }
}

}  // namespace

const char* NameOf(Source source) {
  switch (source) {
    case Source::kTopic:
      return "TOPIC";
    case Source::kFile:
      return "FILE";
    case Source::kTruth:
      return "TRUTH";
    case Source::kStereo:
      break;
  }
  return "STEREO";
}

VisualOdometryOptions OptionsFrom(const Scenario& scenario) {
  const thalweg::VisualOdometry& given = scenario.visual_odometry();
  VisualOdometryOptions options;
  options.source = SourceFrom(given.source());
  options.T_BC = RobotFrom(scenario).T_BC;
  if (options.source == Source::kStereo) options.T_WB_start = StartFrom(scenario);
  if (given.has_features()) options.estimator.features = given.features();
  if (given.has_most_places()) options.estimator.places.most_places = given.most_places();
  // A simulated camera without noise shows the same image, to the last bit, while the robot stands.
  const bool simulated = !scenario.network().wall_clock();
  options.estimator.checks.detect_frozen = !simulated || scenario.stereo_camera().noise_sigma() > 0.0;

  options.topic = given.topic();
  options.topic_is_pose = given.topic_type() == "pose";
  options.T_XB = MakeTransform(
      RotationFromYawPitch(given.body_yaw_deg() * kDegree, given.body_pitch_deg() * kDegree) *
          Eigen::AngleAxisd(given.body_roll_deg() * kDegree, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      ToEigen(given.body_position_m()));
  options.file = given.file();
  if (options.source == Source::kFile && options.file.empty()) {
    throw std::invalid_argument("visual_odometry.file is needed with visual_odometry.source = FILE");
  }
  if (given.has_file_rate_hz()) options.file_rate = given.file_rate_hz();
  if (given.has_file_offset_s()) options.file_offset = FromSeconds(given.file_offset_s());
  if (given.has_rate_hz()) options.rate = given.rate_hz();
  return options;
}

}  // namespace thalweg::visual_odometry
