#pragma once

#include <Eigen/Core>
#include <vector>

namespace thalweg {

/// Evenly spread unit vectors: a Fibonacci lattice on the sphere, from the pole +z down to -z [Gonzalez:
/// Measurement of Areas on a Sphere Using Fibonacci and Latitude-Longitude Lattices, Mathematical Geosciences
/// 42(1), 2010].
std::vector<Eigen::Vector3d> SpreadDirections(std::size_t count);

}  // namespace thalweg
