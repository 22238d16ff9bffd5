#pragma once

#include <filesystem>
#include <string>

#include "common/base/option_visitor.h"
#include "common/geometry/robot_model.h"
#include "common/scenario/scenario.h"
#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::visual_odometry {

/// The source of the pose.
enum class Source : std::uint8_t { kStereo, kTopic, kFile, kTruth };

/// What the topic of a pose from elsewhere carries.
enum class TopicType : std::uint8_t {
  kOdometry,  ///< nav_msgs/Odometry
  kPose,      ///< geometry_msgs/PoseStamped
};

const char* NameOf(Source source);  ///< STEREO, TOPIC, FILE, TRUTH, as in a scenario.

struct VisualOdometryOptions {
  Source source = Source::kStereo;
  VisualOdometry::Options estimator;
  /// For STEREO: pose of the body at the first image.
  RigidTransform T_WB_start = RigidTransform::Identity();
  RigidTransform T_BC = RobotModel().T_BC;

  std::string topic;  ///< For TOPIC; empty = the default in the table of topics.
  TopicType topic_type = TopicType::kOdometry;
  RigidTransform T_XB = RigidTransform::Identity();  ///< For TOPIC and FILE: pose of our body in theirs.

  std::filesystem::path file;
  double file_rate = 10.0;                  ///< [Hz] For poses without stamps.
  Duration file_offset = Duration(0);       ///< Added to the file's stamps.
  double rate = 50.0;                       ///< [Hz] Rate at which FILE is published.
  Duration longest_gap = FromSeconds(1.0);  ///< Longest gap between two poses of the file.
};

/// Block `visual_odometry`, except for the start, which may be the simulator's.
void Visit(OptionVisitor& visitor, VisualOdometryOptions& options);

/// Throws std::invalid_argument naming the field.
VisualOdometryOptions OptionsFrom(const Scenario& scenario);

}  // namespace thalweg::visual_odometry
