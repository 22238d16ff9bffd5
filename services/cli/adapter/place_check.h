#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/geometry/robot_model.h"
#include "common/scenario/scenario.h"
#include "services/simulator/core/world.h"

namespace thalweg::cli {

/// What is wrong with the height at which a robot that drives starts; empty if nothing is.
std::string FloatingText(const RobotModel& robot, const simulator::World& world,
                         const Eigen::Vector3d& start_W);

/// Checks that the simulator can load its world and that the robot fits at its start, before any process is
/// started. Returns warnings; throws as LoadWorld, CheckExtent and StartFrom do.
std::vector<std::string> CheckPlace(const Scenario& scenario);

}  // namespace thalweg::cli
