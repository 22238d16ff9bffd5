#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/voxel/dense_grid.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// Throws std::invalid_argument when the robot does not fit there, or the bounds leave it out.
void CheckStart(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot);

/// Where in a voxel a robot is that started there: in its centre; one that drives, above or below it, in the
/// plane of its start.
Eigen::Vector3d PlaceIn(const VoxelIndex& voxel, double voxel_size, const RobotModel& robot,
                        const Eigen::Vector3d& start_W);

/// 1 in each voxel within ExploredBounds in which the robot can be (see PlaceIn), connected over voxel faces
/// to where it starts. For one that drives these are voxels of the start's layer. Throws
/// std::invalid_argument when it does not fit at the start.
DenseGrid<std::uint8_t> ReachableVoxels(const World& world, const Eigen::Vector3d& start_W,
                                        const RobotModel& robot, double voxel_size);

/// Where a robot may be put in the space that is connected to a given start.
/// @param room  [m] A body of that radius must fit there, too.
/// @return Not empty. Throws std::invalid_argument when the robot does not fit at the given start, or there
/// is no such place.
std::vector<Eigen::Vector3d> StartPlaces(const World& world, const Eigen::Vector3d& start_W,
                                         const RobotModel& robot, double room);
/// One of the places, looking anywhere, its body level.
RigidTransform RandomStart(std::span<const Eigen::Vector3d> places_W, std::uint32_t seed);
/// Both together.
RigidTransform RandomStart(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot,
                           double room, std::uint32_t seed);

}  // namespace thalweg::simulator
