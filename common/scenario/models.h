#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/geometry/depth_error.h"
#include "common/geometry/map_model.h"
#include "common/geometry/robot_model.h"
#include "scenario.pb.h"

namespace thalweg {

// What several services share, out of a scenario; the defaults stand in the structs.

void Visit(OptionVisitor& visitor, RobotModel& robot);         ///< Block `robot`.
void Visit(OptionVisitor& visitor, DepthSensorModel& sensor);  ///< Block `depth_sensor`.
void Visit(OptionVisitor& visitor, MapModel& map);             ///< Part of block `mapper`.
void Visit(OptionVisitor& visitor, DepthErrorModel& error);    ///< Part of block `mapper`.
/// Size and angle of view, as all blocks of cameras have them.
void Visit(OptionVisitor& visitor, PinholeCamera& camera);

RobotModel RobotFrom(const Scenario& scenario);
DepthSensorModel DepthSensorFrom(const Scenario& scenario);
MapModel MapFrom(const Scenario& scenario);
/// Of the mapper's clouds: as stated in `mapper`, else what the depth sensor's noise makes.
DepthErrorModel DepthErrorFrom(const Scenario& scenario);

Eigen::Vector3d ToEigen(const Vector3& v);
/// [m] Boxes of W in which no part of the robot may be, and nothing is explored.
std::vector<Eigen::AlignedBox3d> NoGoFrom(const Scenario& scenario);

}  // namespace thalweg
