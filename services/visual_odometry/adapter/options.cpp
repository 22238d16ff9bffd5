#include "services/visual_odometry/adapter/options.h"

#include <stdexcept>

#include "common/base/angles.h"
#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"

namespace thalweg::visual_odometry {
namespace {

/// The robot's pose in the map before it has moved: as stated in `visual_odometry`, else in `simulator`.
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

/// Pose of our body in another one; its rotation is roll about x, then pitch, then yaw.
void VisitBody(OptionVisitor& visitor, RigidTransform& T_XB) {
  Eigen::Vector3d p_X = T_XB.translation();
  const Eigen::Matrix3d R_XB = T_XB.linear();
  double yaw = std::atan2(R_XB(1, 0), R_XB(0, 0));
  double pitch = std::asin(R_XB(2, 0));
  double roll = std::atan2(R_XB(2, 1), R_XB(2, 2));
  bool changed = visitor.Vector("body_position_m", p_X);
  changed |= visitor.Degrees("body_yaw_deg", yaw);
  changed |= visitor.Degrees("body_pitch_deg", pitch);
  changed |= visitor.Degrees("body_roll_deg", roll);
  if (!changed) return;
  T_XB = MakeTransform(
      RotationFromYawPitch(yaw, pitch) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      p_X);
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

void Visit(OptionVisitor& visitor, VisualOdometryOptions& options) {
  visitor.Choice("source", options.source,
                 {{NameOf(Source::kStereo), Source::kStereo},
                  {NameOf(Source::kTopic), Source::kTopic},
                  {NameOf(Source::kFile), Source::kFile},
                  {NameOf(Source::kTruth), Source::kTruth}});
  visitor.Whole("features", options.estimator.features);
  visitor.Whole("most_places", options.estimator.places.most_places);
  visitor.Text("topic", options.topic);
  visitor.Choice("topic_type", options.topic_type,
                 {{"ODOMETRY", TopicType::kOdometry}, {"POSE", TopicType::kPose}});
  VisitBody(visitor, options.T_XB);
  std::string file = options.file.string();
  if (visitor.Text("file", file)) options.file = file;
  visitor.Number("file_rate_hz", options.file_rate);
  visitor.Seconds("file_offset_s", options.file_offset);
  visitor.Number("rate_hz", options.rate);
}

VisualOdometryOptions OptionsFrom(const Scenario& scenario) {
  VisualOdometryOptions options;
  ReadOptions(scenario.visual_odometry(), options);
  options.T_BC = RobotFrom(scenario).T_BC;
  if (options.source == Source::kStereo) options.T_WB_start = StartFrom(scenario);
  // A simulated camera without noise gives bitwise identical images while the robot is at rest.
  const bool simulated = !scenario.network().wall_clock();
  options.estimator.checks.detect_frozen = !simulated || scenario.stereo_camera().noise_sigma() > 0.0;
  if (options.source == Source::kFile && options.file.empty()) {
    throw std::invalid_argument("visual_odometry.file is needed with visual_odometry.source = FILE");
  }
  return options;
}

}  // namespace thalweg::visual_odometry
