#pragma once

#include <random>

#include "services/simulator/core/world.h"
#include "tests/support/meshes.h"

namespace thalweg::test {

/// A world in which a sensor stands in the middle.
inline const Eigen::AlignedBox3d kSensorBounds(Eigen::Vector3d(-20, -20, -20), Eigen::Vector3d(20, 20, 20));
/// A camera in the middle that looks along x.
inline const RigidTransform kAhead = MakeTransform(BodyFromOptical(), Eigen::Vector3d::Zero());

/// A wall across the x axis.
inline simulator::World WallAt(double x) {
  simulator::Mesh mesh;
  AddQuad(mesh, {x, -19, -19}, {0, 38, 0}, {0, 0, 38});
  return {mesh, kSensorBounds};
}

/// With each coordinate within `reach` of 0.
inline Eigen::Vector3d RandomPoint(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

}  // namespace thalweg::test
