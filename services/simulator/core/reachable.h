#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/voxel/dense_grid.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// Throws std::invalid_argument when the robot's sphere does not fit there, or the bounds leave it out.
void CheckStart(const World& world, const Eigen::Vector3d& start_W, double radius);

/// 1 in each voxel within the world's bounds in whose centre a sphere can be, connected over voxel faces to
/// where it starts.
/// Throws std::invalid_argument when it does not fit at the start.
DenseGrid<std::uint8_t> ReachableVoxels(const World& world, const Eigen::Vector3d& start_W, double radius,
                                        double voxel_size);

/// Where a robot may be put in the space that is connected to a given start.
/// @param clearance  [m] Least distance from the body's origin to any surface.
/// @return Not empty. Throws std::invalid_argument when the robot does not fit at the given start, or there
/// is no such place.
std::vector<Eigen::Vector3d> StartPlaces(const World& world, const Eigen::Vector3d& start_W, double radius,
                                         double clearance);
/// One of the places, looking anywhere, its body level.
RigidTransform RandomStart(std::span<const Eigen::Vector3d> places_W, std::uint32_t seed);
/// Both together.
RigidTransform RandomStart(const World& world, const Eigen::Vector3d& start_W, double radius,
                           double clearance, std::uint32_t seed);

}  // namespace thalweg::simulator
