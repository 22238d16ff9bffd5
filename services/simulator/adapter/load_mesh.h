#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"
#include "services/simulator/core/mesh.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// The axis of a model that points up. Thalweg's own up axis is z.
enum class UpAxis {
  kZ,
  kY,  ///< Rotated about x: (x, y, z) in the file becomes (x, -z, y).
};

struct LoadedMesh {
  Mesh mesh;
  std::vector<std::string> warnings;  ///< One for each missing material or texture.
};

/// Reads a Wavefront OBJ file with its materials and textures, and splits polygons into triangles.
/// @param scale  Converts file units to meters.
/// Throws std::runtime_error naming the file, and the line if there is one, when the file does not exist, has
/// no faces, has a face that refers to a missing vertex, or has a coordinate that is not a finite number or
/// lies more than 100 km from the origin.
LoadedMesh LoadObj(const std::filesystem::path& file, UpAxis up_axis, double scale);

/// How the file of a world is to be read.
struct WorldOptions {
  UpAxis up_axis = UpAxis::kZ;
  double scale = 1.0;  ///< File units to meters.
};
void Visit(OptionVisitor& visitor, WorldOptions& options);  ///< Block `world`, but for the file and boxes.

/// Where the robot starts, beside the position, which is the middle of the bounds where none is given.
struct StartOptions {
  double yaw = 0.0;        ///< [rad]
  std::uint32_t seed = 0;  ///< For a random place and heading; 0 = as given.
};
void Visit(OptionVisitor& visitor, StartOptions& options);  ///< Part of block `simulator`.

/// Loads the world of a scenario and logs warnings. Bounds default to the extent of the mesh.
World LoadWorld(const Scenario& scenario);

/// One-line summary for the log: the world's file, extent, number of triangles, and the part to be explored.
std::string DescriptionOf(const Scenario& scenario, const World& world);

/// Throws std::invalid_argument naming world.scale when the bounds hold more voxels than fit into memory,
/// which mostly means that the file is not in meters.
void CheckExtent(const World& world, double voxel_size);

/// Start pose of the robot: the scenario's start position or, by default, the center of the bounds; with a
/// start_seed, a random place connected to that position.
/// Throws std::invalid_argument naming simulator.start_position_m when the robot does not fit there.
RigidTransform StartFrom(const Scenario& scenario, const World& world, const RobotModel& robot);
/// The places among which a start_seed chooses. Finding them may take seconds. Throws as StartFrom does.
std::vector<Eigen::Vector3d> StartPlacesFrom(const Scenario& scenario, const World& world,
                                             const RobotModel& robot);

}  // namespace thalweg::simulator
