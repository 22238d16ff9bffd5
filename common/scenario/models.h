#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/geometry/depth_error.h"
#include "common/geometry/map_model.h"
#include "common/geometry/robot_model.h"
#include "scenario.pb.h"

namespace thalweg {

// Options used by several services; their defaults are those of the structs.

void Visit(OptionVisitor& visitor, RobotModel& robot);         ///< Block `robot`.
void Visit(OptionVisitor& visitor, DepthSensorModel& sensor);  ///< Block `depth_sensor`.
void Visit(OptionVisitor& visitor, MapModel& map);             ///< Part of block `mapper`.
void Visit(OptionVisitor& visitor, DepthErrorModel& error);    ///< Part of block `mapper`.
/// Size and field of view, which all camera blocks have.
void Visit(OptionVisitor& visitor, PinholeCamera& camera);

RobotModel RobotFrom(const Scenario& scenario);
DepthSensorModel DepthSensorFrom(const Scenario& scenario);
MapModel MapFrom(const Scenario& scenario);
/// Depth error of the mapper's clouds: as stated in `mapper`, else as it follows from the depth sensor's
/// noise.
DepthErrorModel DepthErrorFrom(const Scenario& scenario);

Eigen::Vector3d ToEigen(const Vector3& v);
/// [m] Boxes in W that no part of the robot may enter and in which nothing is explored.
std::vector<Eigen::AlignedBox3d> NoGoFrom(const Scenario& scenario);

}  // namespace thalweg
