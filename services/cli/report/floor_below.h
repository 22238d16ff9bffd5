#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "common/geometry/robot_model.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::cli {

/// [m] A robot that drives may be so far above the floor: the height of its wheels, and of the voxel that
/// must be free below its body.
constexpr double kHighestOfWheels = 0.25;

/// [m] From the lower end of a robot's body down to the floor: the median of the columns of voxels within 3 m
/// that are free there and below it down to an occupied one. Nothing while too few of them are known.
std::optional<double> FloorBelow(const OccupancyGrid& map, double height, const Eigen::Vector3d& p_W);

/// What is wrong with the height at which a robot that drives is said to be; empty if nothing is, or if it is
/// not known yet.
std::string FloatingText(const RobotModel& robot, const OccupancyGrid& map, const Eigen::Vector3d& p_W);

}  // namespace thalweg::cli
