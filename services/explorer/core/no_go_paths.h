#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/no_go_boxes.h"

namespace thalweg::explorer {

/// The shortest path out of the no-go boxes that the robot has yet to leave [m]; for a robot that must
/// return, one that leads on home, if any does. Empty when there is none.
std::vector<Eigen::Vector3d> PathOutOfNoGo(const Eigen::Vector3d& p_W, NoGoBoxes& no_go, Mission& mission,
                                           Knowledge& knowledge);

/// Draws a no-go box. An Error says why it is not drawn: there are too many, or the robot could not leave it
/// or not return any more.
/// @param p_W           Where the robot is [m].
/// @param robot_radius  [m]
std::optional<Error> DrawNoGo(const Eigen::AlignedBox3d& box_W, const Eigen::Vector3d& p_W,
                              double robot_radius, NoGoBoxes& no_go, Mission& mission, Knowledge& knowledge);

}  // namespace thalweg::explorer
