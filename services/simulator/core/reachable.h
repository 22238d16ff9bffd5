#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/voxel/dense_grid.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// Throws std::invalid_argument when the robot does not fit at the start or the start is outside the bounds.
void CheckStart(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot);

/// The position in a voxel at which a robot is tested: the voxel's center; for a robot that drives, the point
/// above or below the center in the plane of its start.
Eigen::Vector3d PlaceIn(const VoxelIndex& voxel, double voxel_size, const RobotModel& robot,
                        const Eigen::Vector3d& start_W);

/// Flags each voxel within ExploredBounds in which the robot fits (see PlaceIn) and that is connected over
/// voxel faces to the start: 1 = reachable. For a robot that drives, only voxels of the start's layer are
/// flagged. Throws std::invalid_argument when the robot does not fit at the start.
DenseGrid<std::uint8_t> ReachableVoxels(const World& world, const Eigen::Vector3d& start_W,
                                        const RobotModel& robot, double voxel_size);

/// Positions at which a robot may start in the space that is connected to a given start, were the parts that
/// move not there; none is where such a part ever comes.
/// @param room  [m] A body of this radius must fit there as well.
/// @return Never empty. Throws std::invalid_argument when the robot does not fit at the given start or there
/// is no such position.
std::vector<Eigen::Vector3d> StartPlaces(const World& world, const Eigen::Vector3d& start_W,
                                         const RobotModel& robot, double room);
/// Picks one of the positions and a heading at random; the body is level.
RigidTransform RandomStart(std::span<const Eigen::Vector3d> places_W, std::uint32_t seed);
/// Calls StartPlaces and picks one of its positions at random.
RigidTransform RandomStart(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot,
                           double room, std::uint32_t seed);

}  // namespace thalweg::simulator
