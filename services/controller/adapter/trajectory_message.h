#pragma once

#include <vector>

#include "common/base/time.h"
#include "common/dds/topics.h"
#include "services/controller/core/path_follower.h"

namespace thalweg::controller {

/// For topic Trajectory. Everything is in the map's frame, velocities and accelerations too, as flight stacks
/// expect them that read such trajectories.
/// @param begin  The time of the first point.
trajectory_msgs::msg::MultiDOFJointTrajectory TrajectoryToIdl(Time begin,
                                                              const std::vector<TrajectoryPoint>& points);

}  // namespace thalweg::controller
