#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/simulator/core/mesh.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// Which axis of a model points up. Ours is z.
enum class UpAxis {
  kZ,
  kY,  ///< Turned about x: (x, y, z) of the file becomes (x, -z, y).
};

struct LoadedMesh {
  Mesh mesh;
  std::vector<std::string> warnings;  ///< Missing materials and textures.
};

/// Reads a Wavefront OBJ with its materials and textures; polygons become triangles.
/// @param scale  File units to metres.
/// Throws std::runtime_error naming the file, and the line where there is one: no such file, no faces, a face
/// that names a vertex that is not there, a coordinate that is not finite.
LoadedMesh LoadObj(const std::filesystem::path& file, UpAxis up_axis, double scale);

inline constexpr double kUnscaled = 1.0;  ///< The scale of a world that gives none.

/// The world of a scenario; its bounds are the mesh's extent where the scenario gives none. Logs warnings.
World LoadWorld(const Scenario& scenario);

/// What is told of a world: its file, its extent, its triangles, and what is explored of it.
std::string DescriptionOf(const Scenario& scenario, const World& world);

/// Throws std::invalid_argument naming world.scale when the bounds hold more voxels than any computer can:
/// most often a file that is not in metres.
void CheckExtent(const World& world, double voxel_size);

/// Where the robot starts: the scenario's start, the middle of the bounds where there is none, or, with a
/// start_seed, a random place connected to it.
/// Throws std::invalid_argument naming simulator.start_position_m when the robot does not fit there.
RigidTransform StartFrom(const Scenario& scenario, const World& world, const RobotModel& robot);
/// The places that a start_seed chooses from; it may take seconds to find them. Throws as StartFrom.
std::vector<Eigen::Vector3d> StartPlacesFrom(const Scenario& scenario, const World& world,
                                             const RobotModel& robot);

}  // namespace thalweg::simulator
