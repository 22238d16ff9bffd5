#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/scenario/scenario.h"
#include "common/surface_graph/view.h"
#include "services/evaluator/core/stereo_sensor.h"
#include "services/simulator/core/world.h"

namespace thalweg::cli {

/// The stereo camera of a scenario, in this process: the simulator renders its images, and the stereo matcher
/// finds the disparities, with the options of the scenario for both, whether or not the scenario enables
/// them.
class SimulatedCamera {
 public:
  /// @param exact  Whether disparities follow from the true depths in place of matched images.
  /// Throws as LoadScenario, LoadWorld and MakeMatcher do.
  SimulatedCamera(const std::string& scenario, const std::vector<std::string>& overrides, bool exact);

  const PinholeCamera& camera() const { return sensor_.options().rig.camera; }  ///< The left one.
  /// Pose of the camera where the robot starts. Throws as StartFrom does.
  RigidTransform StartPose() const;
  /// Why the robot cannot be where the camera has that pose: it would touch something, or be outside.
  std::optional<Error> WhyNotAt(const RigidTransform& T_WC) const;
  surface::View Look(const RigidTransform& T_WC);
  /// Looks from above a point of a surface, unless the robot would touch something there, or another surface
  /// stands between it and that point: it would then have to be inside of something.
  Result<surface::View> LookFromAbove(const RigidTransform& T_WC, const Eigen::Vector3d& above_W);

 private:
  Scenario scenario_;
  RobotModel robot_;
  simulator::World world_;
  evaluator::StereoSensor sensor_;
  bool exact_;
};

}  // namespace thalweg::cli
